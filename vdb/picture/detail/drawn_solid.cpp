#include "vdb/picture/detail/drawn_solid.h"

namespace spinaltap::detail {

DrawnSolid::DrawnSolid(const DrillBit& bit, const Pose& pose, const Eigen::Array3d& colour)
    : body_(bit, pose), colour_(colour) {}

double DrawnSolid::way_mm(const Vec3& start_mm, const Vec3& direction) const {
  thread_local std::vector<RayStretch> stretches;
  stretches.clear();
  body_.append_stretches(start_mm, direction, stretches);
  join_stretches(stretches);
  for (const RayStretch& stretch : stretches) {
    if (stretch.begin_mm >= 0.0) return stretch.begin_mm;
  }
  return kMissed;
}

}  // namespace spinaltap::detail
