#include "core/points/disc_pattern.h"

#include <cmath>
#include <numbers>

#include "core/base/error.h"

namespace spinaltap {
namespace {

Eigen::Vector2d on_circle(double radius_mm, double turns) {
  const double angle = 2.0 * std::numbers::pi * turns;
  return {radius_mm * std::cos(angle), radius_mm * std::sin(angle)};
}

}  // namespace

DiscPattern::DiscPattern(double radius_mm, double spacing_mm, DiscSubdivision subdivision)
    : spacing_mm_(spacing_mm), subdivision_(subdivision), ring_count_(0) {
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
      if (subdivision == DiscSubdivision::rings) {
        points_mm_.push_back(on_circle(ring_radius_mm, static_cast<double>(i) / static_cast<double>(size)));
        continue;
      }
      const std::size_t corner = i / static_cast<std::size_t>(ring);
      const double share = static_cast<double>(i % static_cast<std::size_t>(ring)) / ring;
      const Eigen::Vector2d begin = on_circle(ring_radius_mm, static_cast<double>(corner) / 6.0);
      const Eigen::Vector2d end = on_circle(ring_radius_mm, static_cast<double>(corner + 1) / 6.0);
      points_mm_.emplace_back(begin + share * (end - begin));
    }
  }
}

int DiscPattern::ring_of(std::size_t index) {
  // Ring k starts at 1 + 3k(k-1): a square root, put right where it rounds.
  if (index == 0) return 0;
  int ring = static_cast<int>(std::lround(std::sqrt(0.25 + static_cast<double>(index - 1) / 3.0)));
  while (ring_start(ring) > index) --ring;
  while (ring_start(ring + 1) <= index) ++ring;
  return ring;
}

double DiscPattern::point_volume_mm3(int ring) const {
  const double cube_mm3 = spacing_mm_ * spacing_mm_ * spacing_mm_;
  // Two triangles of equal sides around each point.
  if (subdivision_ == DiscSubdivision::hexagons) return 0.5 * std::numbers::sqrt3 * cube_mm3;
  // Annulus between (k - 1/2) and (k + 1/2) spacings over its 6k points; the centre has the disc within half a spacing.
  return ring == 0 ? std::numbers::pi / 4.0 * cube_mm3 : std::numbers::pi / 3.0 * cube_mm3;
}

double DiscPattern::deviation_mm(int ring) const {
  return subdivision_ == DiscSubdivision::rings ? 0.0 : ring * spacing_mm_ * kHexagonDeviation;
}

}  // namespace spinaltap
