#pragma once

#include <algorithm>
#include <cmath>

#include "core/base/geometry.h"

/// Implicit shapes, negative inside, that change by at most 1 mm per mm. They need not be distances: Vertebra makes
/// distances of them near its surface. T is double or Dual; lengths in mm.

namespace spinaltap {

/// A value with its three partial derivatives: forward-mode differentiation (Griewank & Walther 2008, chapter 3).
/// Shapes are written once, over `double` or `Dual`, so that a gradient can never disagree with its value.
struct Dual {
  double v = 0.0;
  double dx = 0.0, dy = 0.0, dz = 0.0;
};

inline double value_of(double a) { return a; }
inline double value_of(const Dual& a) { return a.v; }

inline Dual scaled(const Dual& a, double value, double slope) {
  return {value, slope * a.dx, slope * a.dy, slope * a.dz};
}

inline Dual operator+(const Dual& a, const Dual& b) { return {a.v + b.v, a.dx + b.dx, a.dy + b.dy, a.dz + b.dz}; }
inline Dual operator-(const Dual& a, const Dual& b) { return {a.v - b.v, a.dx - b.dx, a.dy - b.dy, a.dz - b.dz}; }
inline Dual operator-(const Dual& a) { return {-a.v, -a.dx, -a.dy, -a.dz}; }
inline Dual operator+(const Dual& a, double b) { return {a.v + b, a.dx, a.dy, a.dz}; }
inline Dual operator+(double a, const Dual& b) { return b + a; }
inline Dual operator-(const Dual& a, double b) { return a + (-b); }
inline Dual operator-(double a, const Dual& b) { return scaled(b, a - b.v, -1.0); }
inline Dual operator*(const Dual& a, double b) { return scaled(a, a.v * b, b); }
inline Dual operator*(double a, const Dual& b) { return b * a; }
inline Dual operator*(const Dual& a, const Dual& b) {
  return {a.v * b.v, a.v * b.dx + b.v * a.dx, a.v * b.dy + b.v * a.dy, a.v * b.dz + b.v * a.dz};
}
inline Dual operator/(const Dual& a, const Dual& b) {
  const double inverse = 1.0 / b.v;
  const double value = a.v * inverse;
  return {value, (a.dx - value * b.dx) * inverse, (a.dy - value * b.dy) * inverse, (a.dz - value * b.dz) * inverse};
}

/// Square root whose slope at 0 is taken as 0: the shapes meet it only on an axis, deep inside.
inline double root(double a) { return std::sqrt(a); }
inline Dual root(const Dual& a) {
  const double value = std::sqrt(a.v);
  return scaled(a, value, value > 0.0 ? 0.5 / value : 0.0);
}
inline double magnitude(double a) { return std::fabs(a); }
inline Dual magnitude(const Dual& a) { return a.v < 0.0 ? -a : a; }

/// The part of `a` outside [low, high], with sign: 0 inside the interval.
template <class T>
T beyond(const T& a, double low, double high) {
  if (value_of(a) < low) return a - low;
  if (value_of(a) > high) return a - high;
  return a * 0.0;
}

}  // namespace spinaltap

namespace spinaltap::shapes {

/// The gradient of a value (mm) at p (mm), by central differences.
template <class Value>
Vec3 slope_of(const Value& value_mm, const Vec3& p) {
  constexpr double kStep = 1e-5;
  Vec3 slope;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 step = kStep * Vec3::Unit(axis);
    slope[axis] = (value_mm(p + step) - value_mm(p - step)) / (2.0 * kStep);
  }
  return slope;
}

template <class T>
struct Point {
  T x, y, z;
};

template <class T>
T dot(const Vec3& a, const Point<T>& p) {
  return p.x * a.x() + p.y * a.y() + p.z * a.z();
}

template <class T>
Point<T> minus(const Point<T>& p, const Vec3& q) {
  return {p.x - q.x(), p.y - q.y(), p.z - q.z()};
}

/// Polynomial smooth minimum (Quilez 2013). It is the plain minimum where a and b differ by `reach` or more, at most
/// reach/4 below it elsewhere, and its gradient lies between those of a and b, so that it keeps the 1 mm per mm bound.
template <class T>
T smooth_min(const T& a, const T& b, double reach) {
  const double difference = value_of(a) - value_of(b);
  if (difference >= reach) return b;
  if (difference <= -reach) return a;
  const T overlap = reach - magnitude(a - b);
  return (difference < 0.0 ? a : b) - overlap * overlap * (0.25 / reach);
}

template <class T>
T smooth_max(const T& a, const T& b, double reach) {
  const double difference = value_of(a) - value_of(b);
  if (difference >= reach) return a;
  if (difference <= -reach) return b;
  const T overlap = reach - magnitude(a - b);
  return (difference > 0.0 ? a : b) + overlap * overlap * (0.25 / reach);
}

/// |a| without its crease: rounded within about `width` of 0.
template <class T>
T soft_magnitude(const T& a, double width) {
  return root(a * a + width * width);
}

/// 0 at and below `low`, 1 at and above `high`, with level ends.
inline double smooth_step(double low, double high, double a) {
  const double t = std::clamp((a - low) / (high - low), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

/// 1 where a signed distance is well below 0, 0 where it is well above: over twice `soft`.
inline double inside(double distance, double soft) { return 1.0 - smooth_step(-soft, soft, distance); }

/// Two unit vectors that, with `axis` (unit), make a right-angled frame; the first one is as near to `hint` as can be.
struct Frame {
  Vec3 thin, wide, axis;
};

inline Frame make_frame(const Vec3& axis, const Vec3& hint) {
  const Vec3 unit = axis.normalized();
  const Vec3 thin = (hint - hint.dot(unit) * unit).normalized();
  return {thin, unit.cross(thin), unit};
}

/// A bar between two points with an elliptic section that tapers, and round ends as long as half its width.
class FlatBar {
 public:
  FlatBar() = default;
  /// `hint` is the direction in which the bar is thin; `width_over_thickness` is at least 1.
  FlatBar(const Vec3& start, const Vec3& end, const Vec3& hint, double start_thickness, double end_thickness,
          double width_over_thickness)
      : frame_(make_frame(end - start, hint)),
        start_(start),
        length_((end - start).norm()),
        start_radius_(0.5 * start_thickness),
        slope_(0.5 * (end_thickness - start_thickness) / length_),
        flatness_(1.0 / width_over_thickness),
        scale_(1.0 / std::sqrt(1.0 + slope_ * slope_)) {}

  template <class T>
  T operator()(const Point<T>& p) const {
    const Point<T> q = minus(p, start_);
    const T u = dot(frame_.thin, q);
    const T v = dot(frame_.wide, q) * flatness_;
    const T along = dot(frame_.axis, q);
    const T end = beyond(along, 0.0, length_);
    const T cap = end * flatness_;
    return (root(u * u + v * v + cap * cap) - (start_radius_ + slope_ * (along - end))) * scale_;
  }

  Box3 bounds() const {
    Box3 box;
    for (const double along : {0.0, length_}) {
      const double radius = start_radius_ + slope_ * along;
      const Vec3 half =
          radius * (frame_.thin.array().square() +
                    (frame_.wide.array().square() + frame_.axis.array().square()) / (flatness_ * flatness_))
                       .sqrt()
                       .matrix();
      const Vec3 centre = start_ + along * frame_.axis;
      box.extend(centre - half).extend(centre + half);
    }
    return box;
  }

 private:
  Frame frame_;
  Vec3 start_ = Vec3::Zero();
  double length_ = 1.0, start_radius_ = 1.0, slope_ = 0.0, flatness_ = 1.0, scale_ = 1.0;
};

/// A box with round edges; the distance is exact.
class RoundPlate {
 public:
  RoundPlate() = default;
  RoundPlate(const Vec3& centre, const Frame& frame, const Vec3& half_size, double edge_radius)
      : centre_(centre), frame_(frame), inner_(half_size.array() - edge_radius), radius_(edge_radius) {}

  template <class T>
  T operator()(const Point<T>& p) const {
    const Point<T> q = minus(p, centre_);
    const T a = magnitude(dot(frame_.thin, q)) - inner_.x();
    const T b = magnitude(dot(frame_.wide, q)) - inner_.y();
    const T c = magnitude(dot(frame_.axis, q)) - inner_.z();
    const double av = value_of(a), bv = value_of(b), cv = value_of(c);
    if (av <= 0.0 && bv <= 0.0 && cv <= 0.0) return (av >= bv && av >= cv ? a : bv >= cv ? b : c) - radius_;
    const T ap = av > 0.0 ? a : a * 0.0;
    const T bp = bv > 0.0 ? b : b * 0.0;
    const T cp = cv > 0.0 ? c : c * 0.0;
    return root(ap * ap + bp * bp + cp * cp) - radius_;
  }

  Box3 bounds() const {
    const Vec3 half = (frame_.thin * inner_.x()).cwiseAbs() + (frame_.wide * inner_.y()).cwiseAbs() +
                      (frame_.axis * inner_.z()).cwiseAbs() + Vec3::Constant(radius_);
    return Box3(centre_ - half, centre_ + half);
  }

 private:
  Vec3 centre_ = Vec3::Zero();
  Frame frame_{Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
  Vec3 inner_ = Vec3::Ones();
  double radius_ = 0.0;
};

}  // namespace spinaltap::shapes
