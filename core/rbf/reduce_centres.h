#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/rbf/rbf_model.h"

namespace spinaltap::detail {

struct ReducedFit {
  RbfModel model;
  std::vector<std::uint32_t> centres;  ///< which of the points, in the order of model.centres_mm
  int rounds = 0;
  int iterations = 0;
};

/// Few centres among the points whose interpolant is within `tolerance_mm` of the value at every point: the greedy
/// choice of Carr et al. 2001, section 4. It begins with a few points spread evenly. A round fits the centres, starting
/// from the last round's weights, looks at all points, and makes centres of the worst of those that are out, none near
/// to another of the same round.
ReducedFit reduce_centres(RadialKernel kernel, std::span<const Vec3> points_mm, std::span<const double> values_mm,
                          double tolerance_mm, double accuracy_mm, const Progress& progress);

/// The same for slabs of z with equally many points, each on its own, then one fit to the centres of all: what the
/// paper did (its 3.2.2) because its tool could not take all points. A point near a slab's border may end up further
/// than the tolerance from the final fit.
ReducedFit reduce_centres_in_slabs(RadialKernel kernel, std::span<const Vec3> points_mm,
                                   std::span<const double> values_mm, std::size_t slabs, double tolerance_mm,
                                   double accuracy_mm, const Progress& progress);

}  // namespace spinaltap::detail
