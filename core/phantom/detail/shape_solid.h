#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/phantom/detail/shapes.h"
#include "core/phantom/solid.h"

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
  constexpr double kMaxGrowth = 1.0 / kSteep;
  const double cautious = second.height / (1.0 + kCaution * std::fabs(second.height));
  const double distance = std::clamp(cautious, std::min(f, kMaxGrowth * f), std::max(f, kMaxGrowth * f));
  return f + weight * (distance - f);
}

}  // namespace spinaltap::shapes

namespace spinaltap {

/// A cortical shell around an even core.
struct ShellBone {
  double cortex_mm = 1.0;
  double cortex_hu = 1100.0;
  double core_hu = 180.0;
};

/// An implicit shape of shapes.h in its own frame, mirrored or not, placed in the patient, as a body of bone.
template <class Shape>
class ShapeSolid : public Solid {
 public:
  /// `side`: 1, or -1 for the mirror image at x = 0.
  ShapeSolid(Shape shape, const Mat3& rotation, const Vec3& position_mm, double side, const ShellBone& bone)
      : shape_(std::move(shape)), rotation_(rotation), position_mm_(position_mm), side_(side), bone_(bone) {}

  void evaluate(std::span<const Vec3> points_mm, std::span<double> values_mm,
                std::span<Vec3> gradients) const override {
    for (std::size_t n = 0; n < points_mm.size(); ++n) {
      values_mm[n] = value_mm(points_mm[n]);
      if (gradients.empty()) continue;
      gradients[n] = shapes::slope_of([this](const Vec3& p) { return value_mm(p); }, points_mm[n]);
    }
  }

  Box3 bounds_mm() const override {
    Box3 box;
    for (int n = 0; n < 8; ++n) {
      Vec3 corner = shape_.bounds().corner(static_cast<Box3::CornerType>(n));
      corner.x() *= side_;
      box.extend(rotation_ * corner + position_mm_);
    }
    return box;
  }

  double hu(const Vec3&, double distance_mm, double aperture_mm) const override {
    const double in_core = aperture_mm > 0.0 ? std::clamp(0.5 - (distance_mm + bone_.cortex_mm) / aperture_mm, 0.0, 1.0)
                                             : (distance_mm < -bone_.cortex_mm ? 1.0 : 0.0);
    return bone_.cortex_hu + in_core * (bone_.core_hu - bone_.cortex_hu);
  }

 private:
  double value_mm(const Vec3& p_patient) const {
    Vec3 p = rotation_.transpose() * (p_patient - position_mm_);
    p.x() *= side_;
    return shapes::near_distance_mm(shape_, p);
  }

  Shape shape_;
  Mat3 rotation_;
  Vec3 position_mm_;
  double side_;
  ShellBone bone_;
};

}  // namespace spinaltap
