#pragma once

#include <algorithm>
#include <cmath>

#include "core/phantom/detail/shapes.h"

namespace spinaltap::shapes {

/// Values up to a band's start are made distances; from its end they are the shape's own. Inside the bone the band is
/// narrower, as thin processes have their middle there.
struct Band {
  double start, end;
};
inline constexpr Band kOutsideBand{0.5, 1.6}, kInsideBand{0.35, 1.05};

/// Distances are lessened by this share a mm, which takes back what Newton's method overshoots.
inline constexpr double kCaution = 0.04;

/// No part is flatter than kSteep at the surface. Below kFlat, where parts face each other, no distance is worked out.
inline constexpr double kFlat = 0.2, kSteep = 0.4;

/// A plane that touches the shape's surface, to first order, below a point: unit normal and the point's height above.
struct Tangent {
  Vec3 normal;
  double height;
  double slope;  ///< of the shape at the foot point, mm per mm
};

template <class Shape>
Tangent tangent_at(const Shape& shape, const Vec3& foot, const Vec3& p) {
  const Dual f = shape(Point<Dual>{{foot.x(), 1.0, 0.0, 0.0}, {foot.y(), 0.0, 1.0, 0.0}, {foot.z(), 0.0, 0.0, 1.0}});
  const Vec3 gradient(f.dx, f.dy, f.dz);
  const double slope = gradient.norm();
  const double divisor = std::max(slope, 0.5 * kFlat);
  const Vec3 normal = gradient / divisor;
  return {normal, (p - foot).dot(normal) + f.v / divisor, slope};
}

/// A shape's value, made a distance near its surface.
///
/// The shape's value f lies between 0 and the distance D, as it grows by at most 1 mm per mm. Near the surface D comes
/// from the tangent plane at the foot point, found by two steps of Newton's method; further away D fades into f, which
/// keeps the bound, as it only lessens the growth.
template <class Shape>
double near_distance_mm(const Shape& shape, const Vec3& p) {
  const double f = shape(Point<double>{p.x(), p.y(), p.z()});
  const Band& band = f < 0.0 ? kInsideBand : kOutsideBand;
  double weight = 1.0 - smooth_step(band.start, band.end, std::fabs(f));
  if (weight <= 0.0) return f;
  const Tangent first = tangent_at(shape, p, p);
  weight *= smooth_step(kFlat, kSteep, first.slope);
  if (weight <= 0.0) return f;
  const Tangent second = tangent_at(shape, p - first.height * first.normal, p);
  constexpr double kMostGrowth = 1.0 / kSteep;
  const double cautious = second.height / (1.0 + kCaution * std::fabs(second.height));
  const double distance = std::clamp(cautious, std::min(f, kMostGrowth * f), std::max(f, kMostGrowth * f));
  return f + weight * (distance - f);
}

}  // namespace spinaltap::shapes
