#include "apps/spinaltap-planner/slices/pane_geometry.h"
#include "core/tool/path_curve.h"

#include <algorithm>
#include <cmath>

namespace spinaltap {
namespace {

constexpr double kFitMargin = 1.06;  ///< room around what is fitted

/// So far inside of the outermost voxel centres (voxels) that rounding does not lead out again.
constexpr double kInsideVoxels = 1e-6;

}  // namespace

PanePlane standard_plane(Plane plane, const Vec3& through_mm) {
  const SliceFrame frame = plane_frame(plane, Vec3::Zero(), Box3(-Vec3::Ones(), Vec3::Ones()), 1.0);
  const Vec3 into = frame.into();
  return {through_mm.dot(into) * into, frame.right, frame.down};
}

SliceFrame pane_frame(const PanePlane& plane, const PaneView& view, const PaneSize& size) {
  SliceFrame frame;
  frame.right = plane.right;
  frame.down = plane.down;
  frame.pixel_mm = view.mm_per_px / size.ratio;
  frame.width = std::max(1, static_cast<int>(std::lround(size.width * size.ratio)));
  frame.height = std::max(1, static_cast<int>(std::lround(size.height * size.ratio)));
  const Eigen::Vector2d to_first = -0.5 * Eigen::Vector2d(frame.width - 1, frame.height - 1);
  const Eigen::Vector2d first_mm = view.middle_mm + frame.pixel_mm * to_first;
  frame.origin_mm = plane.anchor_mm + first_mm.x() * plane.right + first_mm.y() * plane.down;
  return frame;
}

PaneView fitted_view(const PanePlane& plane, const Box3& shown_mm, const PaneSize& size) {
  PaneView view;
  if (shown_mm.isEmpty() || !shown_mm.min().allFinite() || !shown_mm.max().allFinite()) return view;
  Eigen::AlignedBox2d extent_mm;
  for (int i = 0; i < 8; ++i) extent_mm.extend(in_plane(plane, shown_mm.corner(static_cast<Box3::CornerType>(i))));
  view.middle_mm = extent_mm.center();
  const Eigen::Vector2d pixels(std::max(1, size.width), std::max(1, size.height));
  const double wanted = kFitMargin * extent_mm.sizes().cwiseQuotient(pixels).maxCoeff();
  view.mm_per_px = std::clamp(wanted, kFinestMmPerPx, kCoarsestMmPerPx);
  return view;
}

PaneView zoomed_view(const PaneView& view, double factor, const Eigen::Vector2d& about_mm) {
  if (!(factor > 0.0) || !std::isfinite(factor)) return view;
  PaneView zoomed;
  zoomed.mm_per_px = std::clamp(view.mm_per_px / factor, kFinestMmPerPx, kCoarsestMmPerPx);
  zoomed.middle_mm = about_mm + (view.middle_mm - about_mm) * (zoomed.mm_per_px / view.mm_per_px);
  return zoomed;
}

Eigen::Vector2d in_plane(const PanePlane& plane, const Vec3& p_mm) {
  const Vec3 offset = p_mm - plane.anchor_mm;
  return {offset.dot(plane.right), offset.dot(plane.down)};
}

double slice_step_mm(const GridGeometry& grid, const Vec3& direction) {
  Eigen::Index nearest = 0;
  (grid.directions.transpose() * direction).cwiseAbs().maxCoeff(&nearest);
  return grid.spacing_mm[nearest];
}

Vec3 clamped_to_grid(const GridGeometry& grid, const Vec3& p_mm) {
  if (is_in_grid(grid, p_mm)) return p_mm;
  Vec3 p_index = grid.to_index(p_mm);
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const double last = grid.size[static_cast<std::size_t>(axis)] - 1;
    const double inside = std::min(kInsideVoxels, 0.5 * last);
    p_index[axis] = std::clamp(p_index[axis], inside, last - inside);
  }
  return grid.to_patient(p_index);
}

bool is_in_grid(const GridGeometry& grid, const Vec3& p_mm) {
  const Vec3 p_index = grid.to_index(p_mm);
  const Vec3 last(grid.size[0] - 1, grid.size[1] - 1, grid.size[2] - 1);
  return (p_index.array() >= 0.0).all() && (p_index.array() <= last.array()).all();
}

HuWindow dragged_window(const HuWindow& start, double share_right, double share_up) {
  return {start.width_hu * std::exp2(share_right), start.level_hu + share_up * start.width_hu};
}

double scale_bar_mm(double mm_per_px, double max_px) {
  const double max_mm = mm_per_px * max_px;
  const double power = std::pow(10.0, std::floor(std::log10(max_mm)));
  for (const double digit : {5.0, 2.0}) {
    if (digit * power <= max_mm) return digit * power;
  }
  return power;
}

double shown_depth_mm(const DrillPath& path, double depth_mm) {
  return std::clamp(depth_mm, -kBeforeEntryMm, path.length_mm() + kBeyondTargetMm);
}

double depth_of_mm(const DrillPath& path, const Vec3& p_mm) {
  return shown_depth_mm(path, PathCurve(path).nearest_mm(p_mm));
}

Vec3 at_depth(const DrillPath& path, double depth_mm) { return PathCurve(path).at_mm(depth_mm); }

PanePlane plane_down_path(const DrillPath& path, double depth_mm) {
  const Vec3 into = PathCurve(path).direction_at(depth_mm);
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
