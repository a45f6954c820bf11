#pragma once

#include <cmath>

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
