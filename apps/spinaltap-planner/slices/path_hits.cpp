#include "apps/spinaltap-planner/slices/path_hits.h"
#include "core/tool/path_curve.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace spinaltap {
namespace {

using Point = Eigen::Vector2d;

Point pane_point(const SliceFrame& frame, double ratio, const Vec3& p_mm) {
  return frame.to_pixel(p_mm).head<2>() / ratio;
}

double to_segment_px(const Point& p, const Point& a, const Point& b) {
  const Point along = b - a;
  const double squared = along.squaredNorm();
  const double share = squared > 0.0 ? std::clamp((p - a).dot(along) / squared, 0.0, 1.0) : 0.0;
  return (p - a - share * along).norm();
}

/// An end within reach, and how well it suits: pixels away, then pixels off the slice.
struct EndInReach {
  PathEnd end = PathEnd::entry;
  double away_px = std::numeric_limits<double>::infinity();
  double off_slice = 0.0;
};

std::optional<EndInReach> end_in_reach(const SliceFrame& frame, double ratio, const DrillPath& path, const Point& at) {
  std::optional<EndInReach> best;
  for (const PathEnd end : {PathEnd::target, PathEnd::entry}) {
    const Vec3 pixel = frame.to_pixel(end == PathEnd::entry ? path.entry_mm : path.target_mm);
    const EndInReach found{end, (pixel.head<2>() / ratio - at).norm(), std::abs(pixel.z())};
    if (!(found.away_px <= kHandleReachPx)) continue;
    constexpr double kSamePlacePx = 1.0;
    const bool is_same_place = best && std::abs(found.away_px - best->away_px) < kSamePlacePx;
    if (!best || (is_same_place ? found.off_slice < best->off_slice : found.away_px < best->away_px)) best = found;
  }
  return best;
}

}  // namespace

QPointF place_in_pane(const SliceFrame& frame, double ratio, const Vec3& p_mm) {
  const Point p = pane_point(frame, ratio, p_mm);
  return {p.x(), p.y()};
}

Vec3 patient_at(const SliceFrame& frame, double ratio, const QPointF& place) {
  return frame.to_patient(Vec3(place.x() * ratio, place.y() * ratio, 0.0));
}

std::optional<PathHit> hit_path(const SliceFrame& frame, double ratio, const std::vector<DrillPath>& paths, int chosen,
                                const QPointF& place) {
  const Point at(place.x(), place.y());
  std::optional<PathHit> handle;
  std::optional<PathHit> axis;
  double handle_px = std::numeric_limits<double>::infinity();
  double axis_px = kAxisReachPx;
  for (int i = 0; i < static_cast<int>(paths.size()); ++i) {
    const DrillPath& path = paths[static_cast<std::size_t>(i)];
    if (const auto end = end_in_reach(frame, ratio, path, at)) {
      if (i == chosen) return PathHit{i, end->end};
      if (end->away_px < handle_px) handle = PathHit{i, end->end};
      handle_px = std::min(handle_px, end->away_px);
    }
    double away_px = std::numeric_limits<double>::infinity();
    const std::vector<Vec3> places_mm = PathCurve(path).places_mm(1.0);
    for (std::size_t n = 1; n < places_mm.size(); ++n) {
      away_px = std::min(away_px, to_segment_px(at, pane_point(frame, ratio, places_mm[n - 1]),
                                                pane_point(frame, ratio, places_mm[n])));
    }
    const double counted_px = i == chosen ? 0.0 : away_px;
    if (away_px <= kAxisReachPx && counted_px <= axis_px) {
      axis = PathHit{i, std::nullopt};
      axis_px = counted_px;
    }
  }
  return handle ? handle : axis;
}

EndDrag::EndDrag(PlanDocument& document, const PathHit& hit, const SliceFrame& frame, double ratio,
                 const QPointF& place)
    : document_(&document),
      index_(hit.path),
      end_(hit.end.value()),
      frame_(frame),
      ratio_(ratio),
      pressed_(place),
      drag_(document.new_drag()) {
  const DrillPath& path = document.paths().at(static_cast<std::size_t>(index_));
  start_pixel_ = frame.to_pixel(end_ == PathEnd::entry ? path.entry_mm : path.target_mm);
}

void EndDrag::move_to(const QPointF& place) {
  constexpr double kSlipPx = 2.5;
  const QPointF way = place - pressed_;
  is_moving_ = is_moving_ || std::hypot(way.x(), way.y()) > kSlipPx;
  if (!is_moving_ || index_ >= static_cast<int>(document_->paths().size())) return;
  const Vec3 moved_mm = frame_.to_patient(start_pixel_ + ratio_ * Vec3(way.x(), way.y(), 0.0));
  document_->move_end(index_, end_, moved_mm, drag_);
}

void EndDrag::give_up() { document_->give_up(drag_); }

}  // namespace spinaltap
