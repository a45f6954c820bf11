#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/triangle_mesh.h"

namespace spinaltap {

/// Pairs of triangles (the lower index first, in ascending order) that meet anywhere but in a corner or edge they
/// share: they cross, touch, or fold onto each other. Exact for float coordinates within a factor of 10^5 of each
/// other's size: signs that rounding could turn are taken again with twice the digits. A triangle without area meets
/// nothing that it shares a corner with. Throws Error on an index out of range or a vertex that is not finite.
std::vector<std::array<std::uint32_t, 2>> self_intersections(const TriangleMesh& mesh);

}  // namespace spinaltap
