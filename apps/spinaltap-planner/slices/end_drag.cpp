#include "apps/spinaltap-planner/slices/end_drag.h"

#include <cmath>

namespace spinaltap {

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
  if (document_->move_end(index_, end_, moved_mm, drag_)) undo_index_ = document_->undo_stack().index();
}

void EndDrag::give_up() {
  // Where somebody else changed the plan since, the last step is not this drag's.
  if (undo_index_ >= 0 && document_->undo_stack().index() == undo_index_) document_->undo_stack().undo();
  undo_index_ = -1;
}

}  // namespace spinaltap
