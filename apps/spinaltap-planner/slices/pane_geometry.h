#pragma once

#include "apps/report/slice_frame.h"
#include "core/ct/grid_geometry.h"
#include "core/tool/drill_path.h"

namespace spinaltap {

/// The plane that a pane shows, all in patient LPS.
struct PanePlane {
  Vec3 anchor_mm = Vec3::Zero();  ///< a place in it, from which PaneView::middle_mm counts
  Vec3 right = Vec3::UnitX();     ///< unit, along the pane's columns
  Vec3 down = Vec3::UnitY();      ///< unit, along the pane's rows

  /// Unit, away from the viewer.
  Vec3 into() const { return right.cross(down); }
};

/// A pane's size. Logical pixels are those of Qt's positions; the screen's own are `ratio` times as many a side.
struct PaneSize {
  int width = 1;       ///< logical pixels
  int height = 1;      ///< logical pixels
  double ratio = 1.0;  ///< device pixels per logical pixel
};

/// Which part of its plane a pane shows, and how large.
struct PaneView {
  Eigen::Vector2d middle_mm = Eigen::Vector2d::Zero();  ///< right and down from the plane's anchor
  double mm_per_px = 0.2;                               ///< per logical pixel
};

/// As far as zooming goes, mm per logical pixel.
inline constexpr double kFinestMmPerPx = 0.01;
inline constexpr double kCoarsestMmPerPx = 2.0;

/// The standard plane through a place (patient LPS, mm), looked at as Plane has it. Its anchor keeps its place in the
/// plane from slice to slice, so that stepping does not move the picture.
PanePlane standard_plane(Plane plane, const Vec3& through_mm);

/// Where the pane's device pixels lie in the patient.
SliceFrame pane_frame(const PanePlane& plane, const PaneView& view, const PaneSize& size);

/// The view that shows a box (patient LPS, mm) as large as the pane allows.
PaneView fitted_view(const PanePlane& plane, const Box3& shown_mm, const PaneSize& size);

/// The view `factor` times as large about a place of the plane (mm right and down from its anchor), which keeps its
/// pixel.
PaneView zoomed_view(const PaneView& view, double factor, const Eigen::Vector2d& about_mm);

/// A patient position in the plane, mm right and down from its anchor.
Eigen::Vector2d in_plane(const PanePlane& plane, const Vec3& p_mm);

/// One slice of the CT in a direction (unit, patient LPS): the spacing of the grid's axis that is nearest to it.
double slice_step_mm(const GridGeometry& grid, const Vec3& direction);

/// The nearest place inside the grid, where the CT has a value (patient LPS, mm).
Vec3 clamped_to_grid(const GridGeometry& grid, const Vec3& p_mm);
/// Whether the CT has a value there.
bool is_in_grid(const GridGeometry& grid, const Vec3& p_mm);

/// The HU window after a drag by shares of the pane's size: to the right, a width of the pane makes it twice as wide;
/// upwards, a height of the pane raises its level by its width.
HuWindow dragged_window(const HuWindow& start, double share_right, double share_up);

/// The longest of 1, 2, 5, 10, ... mm that takes no more than `max_px` logical pixels.
double scale_bar_mm(double mm_per_px, double max_px);

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
