#pragma once

#include <span>

#include "core/base/geometry.h"

namespace spinaltap::detail {

Vec3 middle_of(std::span<const Vec3> points_mm);

/// What chi-square over its degrees of freedom exceeds once in a thousand times (Wilson & Hilferty 1931): a variance
/// over the one that was to be expected.
double unlikely_variance_ratio(double degrees);

}  // namespace spinaltap::detail
