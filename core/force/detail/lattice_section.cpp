#include "core/force/detail/lattice_section.h"

#include <cmath>
#include <numbers>

#include "core/tool/swept_bit.h"

namespace spinaltap {
namespace {

/// Points of ring k (above 0) within `radius_mm` of a place `offset_mm` from the centre.
double points_within(int ring, double ring_mm, double radius_mm, double offset_mm, double angle_rad) {
  const double all = 6.0 * ring;
  if (ring_mm + offset_mm <= radius_mm) return all;
  if (std::abs(ring_mm - offset_mm) > radius_mm) return 0.0;
  const double cosine =
      (ring_mm * ring_mm + offset_mm * offset_mm - radius_mm * radius_mm) / (2.0 * ring_mm * offset_mm);
  const double half = std::acos(std::fmin(std::fmax(cosine, -1.0), 1.0));
  const double per_rad = all / (2.0 * std::numbers::pi);
  const double count = std::floor((angle_rad + half) * per_rad) - std::ceil((angle_rad - half) * per_rad) + 1.0;
  return std::fmin(std::fmax(count, 0.0), all);
}

}  // namespace

double section_over_points(const DiscPattern& pattern, double radius_mm, double offset_mm, double angle_rad) noexcept {
  const double spacing_mm = pattern.spacing_mm();
  const bool reaches_beyond = offset_mm + radius_mm > (pattern.ring_count() - 0.5) * spacing_mm;
  if (reaches_beyond || pattern.subdivision() != DiscSubdivision::rings) return 1.0;
  const double grown_mm = radius_mm + SweepProfile::kStraightSkinMm;  // as engines have it
  double sum_mm2 = offset_mm <= grown_mm ? pattern.point_volume_mm3(0) / spacing_mm : 0.0;
  double points = 0.0;
  for (int ring = 1; ring < pattern.ring_count(); ++ring) {
    points += points_within(ring, ring * spacing_mm, grown_mm, offset_mm, angle_rad);
  }
  sum_mm2 += points * pattern.point_volume_mm3(1) / spacing_mm;
  return sum_mm2 > 0.0 ? std::numbers::pi * radius_mm * radius_mm / sum_mm2 : 1.0;
}

}  // namespace spinaltap
