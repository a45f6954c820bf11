#pragma once

#include "apps/spinaltap-planner/slices/pane_geometry.h"
#include "core/tool/drill_path.h"

namespace spinaltap {

/// Looking along a path from its entry. Depths are along the path, mm from the entry.
inline constexpr double kDownPathStepMm = 0.25;
inline constexpr double kBeforeEntryMm = 3.0;
inline constexpr double kBeyondTargetMm = 10.0;

/// The depth within what is shown: from kBeforeEntryMm before the entry to kBeyondTargetMm beyond the target.
double shown_depth_mm(const DrillPath& path, double depth_mm);
/// How deep a place (patient LPS, mm) lies, within what is shown.
double depth_of_mm(const DrillPath& path, const Vec3& p_mm);
/// The place on the path's axis (patient LPS, mm).
Vec3 at_depth(const DrillPath& path, double depth_mm);

/// The plane across the path there, seen from the entry; its anchor is on the axis. The patient's head is up as far as
/// the path lets it be; on a path along the body's long axis, the front.
PanePlane plane_down_path(const DrillPath& path, double depth_mm);

/// The axis in the middle, with the tool and the walls around it.
PaneView view_down_path(const PaneSize& size);

}  // namespace spinaltap
