#pragma once

#include "core/ct/ct_volume.h"

namespace spinaltap {

/// A block of voxels of a grid, both ends included.
struct VoxelBlock {
  std::array<int, 3> first{};
  std::array<int, 3> last{};
};

/// The voxels of the grid whose centres lie in the box (patient LPS, mm). On an oblique grid: the smallest block that
/// holds them. Throws Error when the box is empty, not finite, or misses the grid.
VoxelBlock block_in_box(const GridGeometry& geometry, const Box3& box_mm);

/// The smallest block that holds all voxels of the mask and `margin_mm` around them, within the grid. Throws Error when
/// the mask is empty or the margin below 0.
VoxelBlock block_around(const BoneMask& mask, double margin_mm);

/// The block as a CT, or mask, of its own: the same voxels at the same places. Throws Error when the block is not one
/// of the grid.
CtVolume crop(const CtVolume& ct, const VoxelBlock& block);
BoneMask crop(const BoneMask& mask, const VoxelBlock& block);

}  // namespace spinaltap
