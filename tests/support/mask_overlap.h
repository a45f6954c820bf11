#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/ct/ct_volume.h"
#include "core/segment/distance_transform.h"

namespace spinaltap::test {

inline std::ptrdiff_t voxel_count(const BoneMask& mask) {
  return std::count(mask.inside.begin(), mask.inside.end(), 1);
}

/// Twice the voxels in both masks over the voxels in each (Dice 1945).
inline double dice(const BoneMask& a, const BoneMask& b) {
  std::size_t both = 0;
  std::size_t each = 0;
  for (std::size_t v = 0; v < a.inside.size(); ++v) {
    both += a.inside[v] != 0 && b.inside[v] != 0 ? 1U : 0U;
    each += std::size_t{a.inside[v]} + b.inside[v];
  }
  return 2.0 * static_cast<double>(both) / static_cast<double>(each);
}

/// The mask's voxels that have a face neighbour outside it.
inline std::vector<std::uint8_t> surface_voxels(const BoneMask& mask) {
  const GridGeometry& geometry = mask.geometry;
  std::vector<std::uint8_t> surface(mask.inside.size(), 0);
  for (int k = 0; k < geometry.size[2]; ++k) {
    for (int j = 0; j < geometry.size[1]; ++j) {
      for (int i = 0; i < geometry.size[0]; ++i) {
        if (!mask.at(i, j, k)) continue;
        const auto outside = [&](int x, int y, int z) { return !geometry.contains(x, y, z) || !mask.at(x, y, z); };
        surface[geometry.offset(i, j, k)] = outside(i - 1, j, k) || outside(i + 1, j, k) || outside(i, j - 1, k) ||
                                            outside(i, j + 1, k) || outside(i, j, k - 1) || outside(i, j, k + 1);
      }
    }
  }
  return surface;
}

/// Mean distance (mm) from the surface voxels of each mask to the nearest of the other's.
inline double mean_surface_distance_mm(const BoneMask& a, const BoneMask& b) {
  const std::vector<std::uint8_t> surfaces[2] = {surface_voxels(a), surface_voxels(b)};
  double sum_mm = 0.0;
  double count = 0.0;
  for (int side = 0; side < 2; ++side) {
    const std::vector<float> to_other = squared_distance_to(surfaces[1 - side], a.geometry);
    for (std::size_t v = 0; v < to_other.size(); ++v) {
      if (surfaces[side][v] == 0) continue;
      sum_mm += std::sqrt(static_cast<double>(to_other[v]));
      count += 1.0;
    }
  }
  return sum_mm / count;
}

}  // namespace spinaltap::test
