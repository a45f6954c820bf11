#pragma once

#include "core/points/disc_pattern.h"

namespace spinaltap {

/// The section of a hole at right angles to the discs over what the points within it stand for, at a distance of the
/// hole's axis from the discs' centres. A bit whose wall lies on a ring of points cuts that whole ring, or none of it:
/// some per cent, which this puts right. 1 where the hole reaches beyond the outermost ring, and for hexagons.
/// Lengths in mm; `angle_rad`: direction of the hole's axis from the centres.
double section_over_points(const DiscPattern& pattern, double radius_mm, double offset_mm, double angle_rad) noexcept;

}  // namespace spinaltap
