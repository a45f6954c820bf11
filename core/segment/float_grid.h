#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/ct/ct_volume.h"

namespace spinaltap {

/// Numbers on a regular grid, for filters.
struct FloatGrid {
  GridGeometry geometry;
  std::vector<float> values;  ///< geometry.voxel_count() values, i fastest

  float at(int i, int j, int k) const { return values[geometry.offset(i, j, k)]; }
};

/// Whole voxels, both ends included.
struct VoxelBox {
  std::array<int, 3> low{0, 0, 0};
  std::array<int, 3> high{-1, -1, -1};

  bool empty() const { return high[0] < low[0] || high[1] < low[1] || high[2] < low[2]; }
};

/// The smallest box around the mask's voxels; empty when there are none.
VoxelBox mask_box(const BoneMask& mask);

/// The box grown by `margin_mm` on each side; it may reach beyond the grid.
VoxelBox grow_box(const VoxelBox& box, double margin_mm, const GridGeometry& geometry);

/// The geometry of the part of a grid within a box.
GridGeometry crop_geometry(const GridGeometry& geometry, const VoxelBox& box);

/// The CT's numbers within a box; beyond the CT, those of its border.
FloatGrid crop_hu(const CtVolume& ct, const VoxelBox& box);
/// 1 inside the mask and 0 outside it, within a box; 0 beyond the mask's grid.
FloatGrid crop_mask(const BoneMask& mask, const VoxelBox& box);

/// How far gaussian_blur() looks along each axis, in standard deviations; in whole voxels, at least one.
inline constexpr double kBlurReach = 3.0;

/// Gaussian blur of standard deviation `sigma_mm` along each axis, values beyond the border repeating the border's.
/// Bit-identical at any thread count. Throws Error when the width is not above 0 or over 1,000 voxels.
FloatGrid gaussian_blur(const FloatGrid& grid, double sigma_mm);

/// Tri-linear value at grid index coordinates; beyond the border, the border's value.
double sample_clamped(const FloatGrid& grid, const Vec3& p_index);

}  // namespace spinaltap
