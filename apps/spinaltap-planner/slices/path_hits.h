#pragma once

#include <QPointF>

#include <optional>
#include <vector>

#include "apps/report/slice_frame.h"
#include "apps/spinaltap-planner/plan_document.h"

namespace spinaltap {

/// How near a pointer must be to a handle and to an axis, logical pixels.
inline constexpr double kHandleReachPx = 9.0;
inline constexpr double kAxisReachPx = 5.0;

/// What of a plan lies under a pointer.
struct PathHit {
  int path = 0;
  std::optional<PathEnd> end;  ///< nothing: the axis between the ends

  bool operator==(const PathHit&) const = default;
};

/// Where a patient position (mm) lies in a pane, logical pixels as events have them: the middle of device pixel
/// (column, row) is at (column, row) / ratio. The depth across the plane does not count.
QPointF place_in_pane(const SliceFrame& frame, double ratio, const Vec3& p_mm);
/// The patient position (mm) on the slice under a place of the pane.
Vec3 patient_at(const SliceFrame& frame, double ratio, const QPointF& place);

/// The handle under `place`, else the axis. The chosen path comes first, then the nearest; where both ends of a path
/// lie at one place, the one that is nearer to the slice.
std::optional<PathHit> hit_path(const SliceFrame& frame, double ratio, const std::vector<DrillPath>& paths, int chosen,
                                const QPointF& place);

/// An end of a path in the hand, from press to release: one step of undo. It keeps its distance from the slice in which
/// it was taken.
class EndDrag {
 public:
  EndDrag(PlanDocument& document, const PathHit& hit, const SliceFrame& frame, double ratio, const QPointF& place);

  /// Moves the end with the pointer, but for the first pixels, which a click may slip.
  void move_to(const QPointF& place);
  /// Puts the end back as it was.
  void give_up();

  PathHit hit() const { return {index_, end_}; }

 private:
  PlanDocument* document_;
  int index_;
  PathEnd end_;
  SliceFrame frame_;
  double ratio_;
  QPointF pressed_;
  Vec3 start_pixel_;  ///< of the end, with its depth
  std::uint64_t drag_;
  bool is_moving_ = false;
};

}  // namespace spinaltap
