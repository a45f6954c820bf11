#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/ct/ct_volume.h"
#include "core/phantom/spine.h"

namespace spinaltap::test {

/// The voxels whose centres lie in one body of a phantom.
inline BoneMask true_mask(const Spine& spine, std::size_t part, const GridGeometry& geometry) {
  BoneMask mask{geometry, std::vector<std::uint8_t>(geometry.voxel_count(), 0)};
  const Box3 body_mm = spine.part(part).solid->bounds_mm();
  Box3 box;
  for (int n = 0; n < 8; ++n) box.extend(geometry.to_index(body_mm.corner(static_cast<Box3::CornerType>(n))));
  const auto low = [&](int axis) { return std::max(0, static_cast<int>(std::floor(box.min()[axis]))); };
  const auto high = [&](int axis) {
    return std::min(geometry.size[static_cast<std::size_t>(axis)] - 1, static_cast<int>(std::ceil(box.max()[axis])));
  };
  tbb::parallel_for(low(2), high(2) + 1, [&](int k) {
    for (int j = low(1); j <= high(1); ++j) {
      for (int i = low(0); i <= high(0); ++i) {
        if (spine.part_value_mm(part, geometry.to_patient(Vec3(i, j, k))) < 0.0) {
          mask.inside[geometry.offset(i, j, k)] = 1;
        }
      }
    }
  });
  return mask;
}

}  // namespace spinaltap::test
