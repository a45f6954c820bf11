#pragma once

#include "core/tool/drill_path.h"
#include "core/tool/path_curve.h"

namespace spinaltap {

/// Where a tool is against the path that was planned for it: what a navigation picture shows.
struct DistanceToPlan {
  /// Across the path, mm: x and y of PathCurve::axes_at() there. Where the tool's own axis crosses the plane across the
  /// path at its entry, and at its target: where it would come to if it went on as it points. NaN of a tool that does
  /// not point along the path, but across it or backwards.
  Eigen::Vector2d at_entry_mm = Eigen::Vector2d::Zero();
  Eigen::Vector2d at_target_mm = Eigen::Vector2d::Zero();
  Eigen::Vector2d at_tip_mm = Eigen::Vector2d::Zero();  ///< of the tip from the path, where that is nearest
  double angle_deg = 0.0;                               ///< between the tool's axis and the path there, 0 to 180
  double depth_mm = 0.0;                                ///< of the tip along the path; below 0: not yet at the entry
  double left_mm = 0.0;                                 ///< from there to the target; below 0: past it
};

/// `tool`: patient LPS, unit axis. What is not finite comes back as NaN.
DistanceToPlan distance_to_plan(const PathCurve& path, const Pose& tool) noexcept;

}  // namespace spinaltap
