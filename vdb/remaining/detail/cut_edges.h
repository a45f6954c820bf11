#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "vdb/grid/bone_model.h"
#include "vdb/remaining/detail/feature_vertex.h"
#include "vdb/remaining/detail/hole_grid.h"

namespace spinaltap::detail {

/// Which voxels of a block, and of a voxel before it and two behind it on each side, are bone.
class SignRows {
 public:
  SignRows(const HoleGrid& grid, std::size_t block);

  /// x, y, z from -1 to 9.
  bool is_bone(int x, int y, int z) const { return (row(x, y) >> static_cast<unsigned>(z + 1) & 1U) != 0; }
  /// Bit z + 1 for voxel z.
  unsigned row(int x, int y) const { return rows_[place(x, y)]; }
  /// Of the cell whose first corner is that voxel, -1 to 8; see cell_patches.h.
  std::uint8_t code(int x, int y, int z) const;

 private:
  static constexpr int kSide = BlockLattice::kSide + 3;
  static std::size_t place(int x, int y) {
    const int row = (x + 1) * kSide + y + 1;
    return static_cast<std::size_t>(row);
  }
  std::array<std::uint16_t, kSide * kSide> rows_{};
};

/// Where the surface cuts an edge between neighbouring voxels.
struct EdgeCut {
  std::array<int, 3> voxel{};  ///< the edge's first, 0 to 8 within the block
  std::uint8_t axis = 0;
  bool rises = false;    ///< the first voxel is bone
  bool is_wall = false;  ///< cut by what was drilled
  double t = 0.0;        ///< 0 at the first voxel, 1 at the next
  Vec3 normal = Vec3::Zero();

  /// Within the block, in voxels from its first.
  SurfacePlane plane() const;
};

/// All cut edges of the block's 8 x 8 x 8 cells.
std::vector<EdgeCut> find_cut_edges(const BoneModel& bone, const HoleGrid& grid, std::size_t block,
                                    const SignRows& signs);

}  // namespace spinaltap::detail
