#pragma once

#include "apps/spinaltap-planner/slices/path_hits.h"

namespace spinaltap {

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
  int undo_index_ = -1;  ///< of the stack after this drag's step; -1: nothing was moved yet
};

}  // namespace spinaltap
