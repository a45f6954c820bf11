#pragma once

#include <cstdint>
#include <vector>

#include "mesh/detail/collapsed_part.h"

namespace spinaltap::detail {

/// Collapses edges, those that change least first, while all that has gone stays within its tolerance and no angle
/// comes out thin. Vertices of the border stay, as do those that `is_kept`.
void collapse_edges(const FineSurface& fine, PassedVertices& next, CollapsedPart& part,
                    const std::vector<std::uint8_t>& is_kept);

/// Turns and collapses edges around triangles with an angle below `wanted_rad`, and moves their corners, each time so
/// that the smallest angle around gets larger and all that has gone, or was where a corner moved from, stays within its
/// tolerance; a crease goes where nothing else helps. Returns where the vertices are.
std::vector<Eigen::Vector3f> widen_angles(const FineSurface& fine, PassedVertices& next, CollapsedPart& part,
                                          double wanted_rad);

}  // namespace spinaltap::detail
