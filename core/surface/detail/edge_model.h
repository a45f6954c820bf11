#pragma once

#include <span>

#include "core/surface/detail/edge_profile.h"

namespace spinaltap {

/// The blur and the cortex's density that describe many profiles of one CT best, by a direct search over the three
/// numbers for the least squares that fit_edge() leaves of all but the worst tenth. About 1,000 of the profiles, evenly
/// chosen, are used; the defaults, scaled by the voxel, when none shows an edge.
EdgeModel estimate_edge_model(std::span<const EdgeProfile> profiles, const GridGeometry& geometry, double reach_mm);

}  // namespace spinaltap
