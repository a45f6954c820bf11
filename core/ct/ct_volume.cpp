#include "core/ct/ct_volume.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/base/error.h"
#include "core/base/hash.h"

namespace spinaltap {

CtVolume make_ct_volume(const GridGeometry& geometry, std::vector<std::int16_t> hu) {
  check_geometry(geometry, "CT");
  if (hu.size() != geometry.voxel_count()) {
    fail("CT: expected ", geometry.voxel_count(), " voxels, found ", hu.size());
  }
  Fnv1a hash;
  hash.add(geometry.size.data(), sizeof geometry.size);
  hash.add(geometry.origin_mm.data(), 3 * sizeof(double));
  hash.add(geometry.spacing_mm.data(), 3 * sizeof(double));
  hash.add(geometry.directions.data(), 9 * sizeof(double));
  hash.add(hu.data(), hu.size() * sizeof(std::int16_t));
  return {geometry, std::move(hu), hash.hex()};
}

double sample_hu(const CtVolume& ct, const Vec3& p_patient, double outside_hu) {
  return sample_hu_at_index(ct, ct.geometry.to_index(p_patient), outside_hu);
}

double sample_hu_at_index(const CtVolume& ct, const Vec3& p_index, double outside_hu) {
  std::array<int, 3> low{};
  Vec3 t;
  for (int axis = 0; axis < 3; ++axis) {
    const int last = ct.geometry.size[static_cast<std::size_t>(axis)] - 1;
    if (!(p_index[axis] >= 0.0 && p_index[axis] <= last)) return outside_hu;
    const int cell = std::min(static_cast<int>(p_index[axis]), std::max(last - 1, 0));
    low[static_cast<std::size_t>(axis)] = cell;
    t[axis] = p_index[axis] - cell;
  }
  const auto corner = [&](int di, int dj, int dk) -> double {
    return ct.at(std::min(low[0] + di, ct.geometry.size[0] - 1), std::min(low[1] + dj, ct.geometry.size[1] - 1),
                 std::min(low[2] + dk, ct.geometry.size[2] - 1));
  };
  const auto row = [&](int dj, int dk) { return std::lerp(corner(0, dj, dk), corner(1, dj, dk), t.x()); };
  return std::lerp(std::lerp(row(0, 0), row(1, 0), t.y()), std::lerp(row(0, 1), row(1, 1), t.y()), t.z());
}

}  // namespace spinaltap
