#include "core/registration/detail/measured_spread.h"

#include <cmath>

namespace spinaltap::detail {

Vec3 middle_of(std::span<const Vec3> points_mm) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& p_mm : points_mm) sum += p_mm;
  return sum / static_cast<double>(points_mm.size());
}

double unlikely_variance_ratio(double degrees) {
  const double cube = 1.0 - 2.0 / (9.0 * degrees) + 3.09 * std::sqrt(2.0 / (9.0 * degrees));
  return cube * cube * cube;
}

}  // namespace spinaltap::detail
