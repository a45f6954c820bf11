#include "core/ct/ct_volume.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <utility>

#include "core/base/error.h"
#include "core/base/hash.h"

namespace spinaltap {

namespace {

/// The same for the same CT in another format, whose text or floats round places: geometry counts in steps that no
/// decimal number lies between two of, and that are far above such rounding.
WordHash64 begun_whole_hash(const GridGeometry& geometry) {
  const double kPlaceMm = 0.01 * std::numbers::sqrt2;
  const double kSpacingMm = 1e-3 * std::numbers::sqrt2, kDirection = 1e-3 * std::numbers::sqrt2;
  WordHash64 hash;
  const auto add = [&hash](double value, double step) {
    const std::int64_t steps = std::llround(value / step);
    hash.add(&steps, sizeof steps);
  };
  hash.add(geometry.size.data(), sizeof geometry.size);
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    add(geometry.origin_mm[axis], kPlaceMm);
    add(geometry.spacing_mm[axis], kSpacingMm);
  }
  for (Eigen::Index n = 0; n < 9; ++n) add(geometry.directions.data()[n], kDirection);
  return hash;
}

WordHash64 begun_exact_hash(const GridGeometry& geometry) {
  WordHash64 hash;
  hash.add(geometry.size.data(), sizeof geometry.size);
  hash.add(geometry.origin_mm.data(), 3 * sizeof(double));
  hash.add(geometry.spacing_mm.data(), 3 * sizeof(double));
  hash.add(geometry.directions.data(), 9 * sizeof(double));
  return hash;
}

}  // namespace

CtVolume make_ct_volume(const GridGeometry& geometry, std::vector<std::int16_t> hu) {
  check_geometry(geometry, "CT");
  if (hu.size() != geometry.voxel_count()) {
    fail("CT: expected ", geometry.voxel_count(), " voxels, found ", hu.size());
  }
  WordHash64 exact = begun_exact_hash(geometry), whole = begun_whole_hash(geometry);
  WordHash64::add_to_both(exact, whole, hu.data(), hu.size() * sizeof(std::int16_t));
  CtVolume ct{.geometry = geometry, .hu = std::move(hu), .source_hash = exact.hex()};
  ct.whole_hash = whole.hex();
  return ct;
}

double sample_hu(const CtVolume& ct, const Vec3& p_patient, double outside_hu) {
  return sample_hu_at_index(ct, ct.geometry.to_index(p_patient), outside_hu);
}

double sample_hu_at_index(const CtVolume& ct, const Vec3& p_index, double outside_hu) {
  std::size_t first = 0;
  std::array<std::size_t, 3> next{};  // to the other corner; where there is but one, to itself
  Vec3 t;
  std::size_t stride = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const auto n = static_cast<std::size_t>(axis);
    const int last = ct.geometry.size[n] - 1;
    if (!(p_index[axis] >= 0.0 && p_index[axis] <= last)) return outside_hu;
    const int cell = std::min(static_cast<int>(p_index[axis]), std::max(last - 1, 0));
    t[axis] = p_index[axis] - cell;
    first += stride * static_cast<std::size_t>(cell);
    next[n] = last > 0 ? stride : 0;
    stride *= static_cast<std::size_t>(last + 1);
  }
  const std::int16_t* corner = ct.hu.data() + first;
  const auto row = [&](const std::int16_t* at) { return at[0] + t.x() * (at[next[0]] - at[0]); };
  const auto face = [&](const std::int16_t* at) {
    const double near = row(at);
    return near + t.y() * (row(at + next[1]) - near);
  };
  const double near = face(corner);
  return near + t.z() * (face(corner + next[2]) - near);
}

}  // namespace spinaltap
