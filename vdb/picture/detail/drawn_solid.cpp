#include "vdb/picture/detail/drawn_solid.h"

#include <algorithm>
#include <cmath>

namespace spinaltap::detail {

DrawnSolid::DrawnSolid(const DrillBit& bit, const Pose& pose, const Eigen::Array3d& colour)
    : profile_(bit), pose_(pose), colour_(colour) {}

double DrawnSolid::distance_mm(const Vec3& p_mm) const {
  const Vec3 from_tip_mm = p_mm - pose_.tip_mm;
  const double back_mm = -from_tip_mm.dot(pose_.axis);
  return profile_.distance_mm(back_mm, (from_tip_mm + back_mm * pose_.axis).norm());
}

double DrawnSolid::way_mm(const Vec3& start_mm, const Vec3& direction) const {
  constexpr double kNearMm = 1e-3;
  constexpr int kMaxSteps = 400;
  const Vec3 centre_mm = pose_.tip_mm - 0.5 * profile_.length_mm() * pose_.axis;
  const double radius_mm = std::hypot(0.5 * profile_.length_mm(), profile_.radius_mm()) + kNearMm;
  const double nearest_mm = (centre_mm - start_mm).dot(direction);
  const double past_mm = (start_mm + nearest_mm * direction - centre_mm).norm();
  if (past_mm >= radius_mm) return kMissed;
  const double half_mm = std::sqrt(radius_mm * radius_mm - past_mm * past_mm);
  // The distance is exact, so that no step of it goes through the surface (Hart 1996).
  double way_mm = std::max(0.0, nearest_mm - half_mm);
  for (int step = 0; step < kMaxSteps && way_mm <= nearest_mm + half_mm; ++step) {
    const double free_mm = distance_mm(start_mm + way_mm * direction);
    if (free_mm < kNearMm) return way_mm;
    way_mm += free_mm;
  }
  return kMissed;
}

Vec3 DrawnSolid::normal(const Vec3& p_mm) const {
  constexpr double kStepMm = 1e-3;
  Vec3 slope;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 step = kStepMm * Vec3::Unit(axis);
    slope[axis] = distance_mm(p_mm + step) - distance_mm(p_mm - step);
  }
  return slope.norm() > 0.0 ? slope.normalized() : pose_.axis;
}

}  // namespace spinaltap::detail
