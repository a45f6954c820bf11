#pragma once

#include "core/base/point_grid.h"

namespace spinaltap {

/// How far along `direction` (a unit vector away from the surface at p_mm) an off-surface point may lie, at most
/// `wanted_mm`: no part of the surface in `grid` but its own may be nearer to it. 0 where there is no room.
/// Source: Carr et al. 2001, section 3, who validate the distance in the same way.
double off_surface_length_mm(const PointGrid& grid, const Vec3& p_mm, const Vec3& direction, double wanted_mm);

}  // namespace spinaltap
