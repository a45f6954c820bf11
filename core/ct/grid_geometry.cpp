#include "core/ct/grid_geometry.h"

#include <cmath>

#include "core/base/error.h"

namespace spinaltap {

void check_geometry(const GridGeometry& geometry, const char* what, std::size_t max_voxels) {
  const auto& size = geometry.size;
  if (size[0] < 1 || size[1] < 1 || size[2] < 1) {
    fail(what, ": expected at least one voxel along each axis, found ", size[0], " x ", size[1], " x ", size[2]);
  }
  // Divisions instead of products, so that absurd sizes cannot overflow the check.
  const auto columns = static_cast<std::size_t>(size[0]);
  const auto rows = static_cast<std::size_t>(size[1]);
  const auto slices = static_cast<std::size_t>(size[2]);
  if (columns > max_voxels / rows / slices) {
    fail(what, ": expected at most ", max_voxels, " voxels, found ", columns, " x ", rows, " x ", slices);
  }
  if (!geometry.origin_mm.allFinite()) fail(what, ": the position of the first voxel is not a number");
  for (int axis = 0; axis < 3; ++axis) {
    const double step_mm = geometry.spacing_mm[axis];
    if (!(step_mm > 0.0) || !std::isfinite(step_mm)) {
      fail(what, ": expected voxel steps above 0 mm, found ", step_mm, " mm along axis ", axis);
    }
  }
  const Mat3 product = geometry.directions.transpose() * geometry.directions;
  // Compared one by one: a largest element would pass over NaN.
  if (!((product - Mat3::Identity()).array().abs() < 1e-3).all()) {
    fail(what, ": expected unit axes at right angles, found axes that are not");
  }
}

Vec3 GridGeometry::to_index(const Vec3& p_patient) const {
  return (directions.inverse() * (p_patient - origin_mm)).cwiseQuotient(spacing_mm);
}

}  // namespace spinaltap
