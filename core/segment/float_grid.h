#pragma once

#include <algorithm>
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

/// Gaussian blur of standard deviation `sigma_mm` along each axis, values beyond the border repeating the border's.
/// Bit-identical at any thread count. Throws Error when the width is not above 0 or over 1,000 voxels.
FloatGrid gaussian_blur(const FloatGrid& grid, double sigma_mm);

/// Tri-linear value at grid index coordinates; beyond the border, the border's value.
inline double sample_clamped(const FloatGrid& grid, const Vec3& p_index) {
  const std::array<std::size_t, 3> strides{1, grid.geometry.offset(0, 1, 0), grid.geometry.offset(0, 0, 1)};
  std::size_t low = 0;
  std::array<std::size_t, 3> step{};  // to the higher voxel, none at the border
  Vec3 t;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<Eigen::Index>(axis);
    const int last = grid.geometry.size[axis] - 1;
    const double p = std::clamp(p_index[a], 0.0, static_cast<double>(last));
    const int below = static_cast<int>(p);
    low += static_cast<std::size_t>(below) * strides[axis];
    step[axis] = below < last ? strides[axis] : 0;
    t[a] = p - below;
  }
  // Not std::lerp: its care for special cases takes most of the time of those who ask millions of times.
  const auto mix = [](double at_low, double at_high, double share) { return at_low + share * (at_high - at_low); };
  const float* const corner = grid.values.data() + low;
  const auto row = [&](std::size_t offset) {
    return mix(static_cast<double>(corner[offset]), static_cast<double>(corner[offset + step[0]]), t.x());
  };
  return mix(mix(row(0), row(step[1]), t.y()), mix(row(step[2]), row(step[1] + step[2]), t.y()), t.z());
}

}  // namespace spinaltap
