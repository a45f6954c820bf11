#include "apps/spinaltap-planner/slices/down_path.h"

#include <algorithm>

namespace spinaltap {

double shown_depth_mm(const DrillPath& path, double depth_mm) {
  return std::clamp(depth_mm, -kBeforeEntryMm, path.length_mm() + kBeyondTargetMm);
}

double depth_of_mm(const DrillPath& path, const Vec3& p_mm) {
  return shown_depth_mm(path, (p_mm - path.entry_mm).dot(path.direction()));
}

Vec3 at_depth(const DrillPath& path, double depth_mm) { return path.entry_mm + depth_mm * path.direction(); }

PanePlane plane_down_path(const DrillPath& path, double depth_mm) {
  const Vec3 into = path.direction();
  const auto across = [&](const Vec3& wanted) { return Vec3(wanted - wanted.dot(into) * into); };
  Vec3 up = across(Vec3::UnitZ());
  if (up.norm() < 1e-3) up = across(-Vec3::UnitY());
  const Vec3 down = -up.normalized();
  return {at_depth(path, depth_mm), down.cross(into), down};
}

PaneView view_down_path(const PaneSize& size) {
  constexpr double kAcrossMm = 36.0;  // a lumbar pedicle with the canal beside it
  return {Eigen::Vector2d::Zero(), kAcrossMm / std::max(1, std::min(size.width, size.height))};
}

}  // namespace spinaltap
