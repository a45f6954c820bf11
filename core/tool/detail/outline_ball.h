#pragma once

#include <cmath>

#include "core/tool/drill_bit.h"

namespace spinaltap::detail {

/// The ball that an arc is of.
struct OutlineBall {
  double centre_mm = 0.0;  ///< back from the tip, on the axis
  double radius_mm = 0.0;
};

/// The one whose surface two places are on, one further back than the other.
inline OutlineBall ball_through(const OutlinePoint& from, const OutlinePoint& to) {
  const double centre_mm = 0.5 * (from.back_mm + to.back_mm) + 0.5 * (to.radius_mm - from.radius_mm) *
                                                                   (to.radius_mm + from.radius_mm) /
                                                                   (to.back_mm - from.back_mm);
  return {centre_mm, std::hypot(from.back_mm - centre_mm, from.radius_mm)};
}

}  // namespace spinaltap::detail
