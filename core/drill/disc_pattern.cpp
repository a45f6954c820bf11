#include "core/drill/disc_pattern.h"

#include <cmath>
#include <numbers>

#include "core/base/error.h"

namespace spinaltap {

DiscPattern::DiscPattern(double radius_mm, double spacing_mm) : spacing_mm_(spacing_mm), ring_count_(0) {
  constexpr int kMaxRings = 4096;
  if (!(radius_mm > 0.0) || !(spacing_mm > 0.0) || !std::isfinite(radius_mm) || !std::isfinite(spacing_mm)) {
    fail("point volume: expected radius and spacing above 0 mm, found ", radius_mm, " and ", spacing_mm, " mm");
  }
  const double rings = std::round(radius_mm / spacing_mm);
  if (!(rings >= 1.0 && rings <= kMaxRings)) {
    fail("point volume: expected radius / spacing between 1 and ", kMaxRings, ", found ", radius_mm, " / ", spacing_mm);
  }
  ring_count_ = static_cast<int>(rings);
  points_mm_.reserve(ring_start(ring_count_));
  points_mm_.emplace_back(0.0, 0.0);
  for (int ring = 1; ring < ring_count_; ++ring) {
    const double ring_radius_mm = ring * spacing_mm;
    const std::size_t size = ring_size(ring);
    for (std::size_t i = 0; i < size; ++i) {
      const double angle = 2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(size);
      points_mm_.emplace_back(ring_radius_mm * std::cos(angle), ring_radius_mm * std::sin(angle));
    }
  }
}

double DiscPattern::point_volume_mm3(int ring) const {
  const double cube_mm3 = spacing_mm_ * spacing_mm_ * spacing_mm_;
  // Annulus between (k - 1/2) and (k + 1/2) spacings over its 6k points; the centre has the disc within half a spacing.
  return ring == 0 ? std::numbers::pi / 4.0 * cube_mm3 : std::numbers::pi / 3.0 * cube_mm3;
}

}  // namespace spinaltap
