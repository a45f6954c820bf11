#include "core/plan/path_angles.h"

#include <cmath>

namespace spinaltap {

PathAngles path_angles(const Vec3& direction, const Mat3& axes, bool is_left) {
  const Vec3 own = axes.transpose() * direction;
  const double inward = is_left ? -own.x() : own.x();
  return {std::atan2(inward, -own.y()) / kDegree, std::atan2(own.z(), std::hypot(own.x(), own.y())) / kDegree};
}

}  // namespace spinaltap
