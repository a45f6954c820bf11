#include "mesh/detail/orientation.h"

#include <cmath>
#include <limits>

namespace spinaltap::detail {
namespace {

/// A number of twice the digits: high + low, where low is what high rounded away.
struct Pair {
  double high = 0.0;
  double low = 0.0;
};

Pair sum(double a, double b) {
  const double s = a + b;
  const double part = s - a;
  return {s, (a - (s - part)) + (b - part)};
}

Pair product(double a, double b) {
  const double p = a * b;
  return {p, std::fma(a, b, -p)};
}

Pair operator+(const Pair& a, const Pair& b) {
  const Pair high = sum(a.high, b.high);
  const Pair low = sum(a.low, b.low);
  const Pair first = sum(high.high, high.low + low.high);
  return sum(first.high, first.low + low.low);
}

Pair operator-(const Pair& a) { return {-a.high, -a.low}; }

Pair operator*(const Pair& a, double b) {
  const Pair high = product(a.high, b);
  const Pair low = product(a.low, b);
  return high + low;
}

int sign(double value) { return value > 0.0 ? 1 : value < 0.0 ? -1 : 0; }

}  // namespace

int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 u = b - a;
  const Vec3 v = c - a;
  const Vec3 w = d - a;
  const double determinant = u.cross(v).dot(w);
  const Vec3 absolute = u.cwiseAbs();
  const double size = absolute.x() * (std::abs(v.y() * w.z()) + std::abs(v.z() * w.y())) +
                      absolute.y() * (std::abs(v.z() * w.x()) + std::abs(v.x() * w.z())) +
                      absolute.z() * (std::abs(v.x() * w.y()) + std::abs(v.y() * w.x()));
  constexpr double kRounding = 8.0 * std::numeric_limits<double>::epsilon();
  if (std::abs(determinant) > kRounding * size) return sign(determinant);
  const Pair x = product(v.y(), w.z()) + -product(v.z(), w.y());
  const Pair y = product(v.z(), w.x()) + -product(v.x(), w.z());
  const Pair z = product(v.x(), w.y()) + -product(v.y(), w.x());
  const Pair exact = x * u.x() + y * u.y() + z * u.z();
  return exact.high != 0.0 ? sign(exact.high) : sign(exact.low);
}

}  // namespace spinaltap::detail
