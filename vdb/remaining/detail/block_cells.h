#pragma once

#include <cstdint>
#include <vector>

#include "vdb/grid/bone_model.h"
#include "vdb/remaining/detail/hole_grid.h"

namespace spinaltap::detail {

/// The surface in a block of 8 x 8 x 8 cells; cell (x, y, z) has voxel (x, y, z) of the block for its first corner.
struct BlockCells {
  struct Vertex {
    Eigen::Vector3f position_mm;             ///< patient LPS
    std::array<Eigen::Vector3f, 2> normals;  ///< of the bone's surface and of the drilled wall; zero without either
    bool operator==(const Vertex&) const = default;
  };
  /// A cell that the surface cuts.
  struct Cell {
    std::uint16_t place = 0;  ///< BlockLattice::offset()
    std::uint16_t first_vertex = 0;
    std::uint8_t code = 0;  ///< see cell_patches.h
    bool joined = false;
    bool operator==(const Cell&) const = default;
  };
  /// An edge that the surface cuts and that begins at a voxel of the block.
  struct Edge {
    std::uint16_t place = 0;  ///< of its first voxel
    std::uint8_t axis = 0;
    bool rises = false;    ///< the first voxel is bone
    bool is_wall = false;  ///< cut by what was drilled
    Eigen::Vector3f normal;
    bool operator==(const Edge&) const = default;
  };
  std::vector<Cell> cells;                     ///< by place
  std::array<std::uint16_t, 65> row_begins{};  ///< where in `cells` those of each row along z begin; one past the last
  std::vector<Vertex> vertices;
  std::vector<Edge> edges;

  /// Null where the surface does not cut the cell.
  const Cell* find(std::uint16_t place) const;
  bool operator==(const BlockCells&) const = default;
};

/// Whether the surface may cut a cell of the block: a glance at its voxels and the next ones.
bool may_have_surface(const HoleGrid& grid, std::size_t block);

/// Dual contouring of one block, which must have neighbours on all sides: where the surface cuts the cells' edges, on
/// the bone's field as it was baked or on the hole's, whichever comes first from within; the normals there; and a
/// vertex for each piece of surface in a cell.
BlockCells find_cells(const BoneModel& bone, const HoleGrid& grid, std::size_t block);

}  // namespace spinaltap::detail
