#pragma once

#include "core/base/geometry.h"

namespace spinaltap::detail {

/// Sign of (b - a) x (c - a) . (d - a): 1 where d lies on the side to which the triangle abc faces, 0 in its plane.
/// Coordinates must be floats: the differences are then exact, and the determinant is taken with twice a double's
/// digits where rounding could turn its sign (after Shewchuk 1997, "Adaptive precision floating-point arithmetic").
int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

}  // namespace spinaltap::detail
