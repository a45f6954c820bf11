#include "core/base/geometry.h"

#include <cmath>

namespace spinaltap {

Vec3 any_perpendicular(const Vec3& axis) {
  // The coordinate axis least along `axis` gives the best-conditioned cross product.
  int min = 0;
  for (int i = 1; i < 3; ++i) {
    if (std::abs(axis[i]) < std::abs(axis[min])) min = i;
  }
  return axis.cross(Vec3::Unit(min)).normalized();
}

double angle_between_rad(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

Box3 bounds_of(std::span<const Vec3> points) {
  Box3 box;
  for (const Vec3& p : points) box.extend(p);
  return box;
}

}  // namespace spinaltap
