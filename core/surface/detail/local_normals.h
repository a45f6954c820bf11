#pragma once

#include <span>
#include <vector>

#include "core/base/geometry.h"

namespace spinaltap {

/// Unit normals of a point field: of each point, the direction in which its neighbours within `radius_mm` spread least,
/// on the side of `outward` (any length). Neighbours that face away, by their own `outward`, do not count. A point with
/// fewer than 3 neighbours, or with a straight line of them, keeps its outward direction. Source: Hoppe et al. 1992,
/// "Surface reconstruction from unorganized points", section 3.1, but for the orientation, which is given here.
std::vector<Vec3> local_normals(std::span<const Vec3> points_mm, std::span<const Vec3> outward, double radius_mm);

}  // namespace spinaltap
