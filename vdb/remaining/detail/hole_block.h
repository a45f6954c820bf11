#pragma once

#include <array>

#include "vdb/remaining/detail/block_lattice.h"

namespace spinaltap::detail {

/// A block of what was drilled: at each voxel the distance to all that bits swept (mm, negative within, clamped to the
/// band) and its gradient.
struct HoleBlock {
  std::array<float, BlockLattice::kVoxels> distance_mm;
  std::array<Eigen::Vector3f, BlockLattice::kVoxels> gradient;
};

/// Box around voxels of a block; empty where low > high.
struct BlockBox {
  static constexpr int kLast = BlockLattice::kSide - 1;
  std::array<int, 3> low{BlockLattice::kSide, BlockLattice::kSide, BlockLattice::kSide};
  std::array<int, 3> high{-1, -1, -1};

  static BlockBox whole() { return {{0, 0, 0}, {kLast, kLast, kLast}}; }
  bool empty() const { return high[0] < 0; }
  void extend(const std::array<int, 3>& voxel);
  void extend(const BlockBox& box);
};

/// What changed in a block.
struct BlockChange {
  BlockBox values;  ///< voxels whose distance to the hole changed
  BlockBox signs;   ///< voxels that were bone and are not, or the other way
};

}  // namespace spinaltap::detail
