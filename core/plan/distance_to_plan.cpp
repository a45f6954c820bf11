#include "core/plan/distance_to_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/geometry.h"

namespace spinaltap {
namespace {

/// Where the tool's axis crosses the plane across the path there.
Eigen::Vector2d crossing_mm(const PathCurve& path, double along_mm, const Pose& tool) {
  constexpr double kLeastCosine = 1e-3;  // beyond, the crossing is further away than a room is wide
  const Mat3 axes = path.axes_at(along_mm);
  const Vec3 direction = axes.transpose() * tool.axis;
  if (!(direction.z() > kLeastCosine)) return Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
  const Vec3 tip_mm = axes.transpose() * (tool.tip_mm - path.at_mm(along_mm));
  return tip_mm.head<2>() - tip_mm.z() / direction.z() * direction.head<2>();
}

}  // namespace

DistanceToPlan distance_to_plan(const PathCurve& path, const Pose& tool) noexcept {
  DistanceToPlan distance;
  if (!tool.tip_mm.allFinite() || !tool.axis.allFinite()) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    distance.at_entry_mm = distance.at_target_mm = distance.at_tip_mm = Eigen::Vector2d::Constant(kNone);
    distance.angle_deg = distance.depth_mm = distance.left_mm = kNone;
    return distance;
  }
  distance.depth_mm = path.nearest_mm(tool.tip_mm);
  distance.left_mm = path.length_mm() - distance.depth_mm;
  const Mat3 axes = path.axes_at(distance.depth_mm);
  distance.at_tip_mm = (axes.transpose() * (tool.tip_mm - path.at_mm(distance.depth_mm))).head<2>();
  distance.angle_deg = angle_between_rad(tool.axis, axes.col(2)) / kDegree;
  distance.at_entry_mm = crossing_mm(path, 0.0, tool);
  distance.at_target_mm = crossing_mm(path, path.length_mm(), tool);
  return distance;
}

}  // namespace spinaltap
