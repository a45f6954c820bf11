#pragma once

#include <vector>

#include "core/phantom/solid.h"

namespace spinaltap {

/// Points (patient LPS, mm) within `spacing_mm` of the solid's surface, such that every point of the surface has one
/// within `spacing_mm`. They are the centres of the cubes of an octree, with sides of at most spacing_mm, that the
/// surface may cross: |value| is at most half their diagonal. The order depends on nothing but the arguments.
/// Throws Error when the spacing is not above 0 or asks for over 10^9 cubes.
std::vector<Vec3> surface_seeds(const Solid& solid, double spacing_mm);

}  // namespace spinaltap
