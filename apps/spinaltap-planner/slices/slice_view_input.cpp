// What mouse and keys do in a slice.
#include <QKeyEvent>
#include <QMouseEvent>
#include <QWheelEvent>
#include <cmath>

#include "apps/spinaltap-planner/slices/slice_view.h"
#include "apps/spinaltap-planner/window/mouse_place.h"

namespace spinaltap {
namespace {

constexpr double kZoomPerNotch = 1.2;
constexpr int kNotch = 120;  ///< eighths of a degree: QWheelEvent

int times_with_shift(Qt::KeyboardModifiers keys) { return keys.testFlag(Qt::ShiftModifier) ? 10 : 1; }

/// To the right and down the pane.
std::optional<QPoint> way_of_arrow(int key) {
  switch (key) {
    case Qt::Key_Left:
      return QPoint(-1, 0);
    case Qt::Key_Right:
      return QPoint(1, 0);
    case Qt::Key_Up:
      return QPoint(0, -1);
    case Qt::Key_Down:
      return QPoint(0, 1);
    default:
      return std::nullopt;
  }
}

}  // namespace

SliceView::Gesture SliceView::gesture_of(Qt::MouseButton button, Qt::KeyboardModifiers keys, const QPointF& place) {
  if (button == Qt::RightButton) return Gesture::window;
  if (button == Qt::MiddleButton) return Gesture::pan;
  if (button != Qt::LeftButton) return Gesture::none;
  if (keys.testFlag(Qt::ShiftModifier)) return Gesture::pan;
  const auto hit = hit_path(frame(), devicePixelRatioF(), document_.paths(), document_.chosen(), place);
  if (hit && hit->path != document_.chosen()) {
    document_.choose(hit->path);
    return Gesture::none;
  }
  if (!hit || !hit->end) return Gesture::crosshair;
  grip_.plane = plane();
  grip_.end.emplace(document_, *hit, frame(), devicePixelRatioF(), place);
  return Gesture::end;
}

void SliceView::mousePressEvent(QMouseEvent* event) {
  if (grip_.gesture != Gesture::none || !plane()) return;
  grip_.pressed = mouse_in_widget(*event);
  grip_.button = event->button();
  grip_.view = view_;
  grip_.window = state_.window();
  grip_.crosshair_mm = state_.crosshair_mm();
  grip_.gesture = gesture_of(event->button(), event->modifiers(), mouse_in_widget(*event));
  if (grip_.gesture == Gesture::crosshair) go_on(mouse_in_widget(*event));
  update_cursor(event->modifiers());
  update();
}

void SliceView::go_on(const QPointF& place) {
  const QPointF way = place - grip_.pressed;
  switch (grip_.gesture) {
    case Gesture::none:
      return;
    case Gesture::crosshair:
      put_crosshair(position_at(place));
      return;
    case Gesture::end:
      grip_.end->move_to(place);
      return;
    case Gesture::pan:
      view_.middle_mm = grip_.view.middle_mm - view_.mm_per_px * Eigen::Vector2d(way.x(), way.y());
      is_fitted_ = false;
      look_again();
      return;
    case Gesture::window:
      state_.set_window(dragged_window(grip_.window, way.x() / width(), -way.y() / height()));
      return;
  }
}

void SliceView::mouseMoveEvent(QMouseEvent* event) {
  if (grip_.gesture != Gesture::none) go_on(mouse_in_widget(*event));
  point_at(mouse_in_widget(*event), event->modifiers());
}

void SliceView::mouseReleaseEvent(QMouseEvent* event) {
  if (event->button() != grip_.button) return;
  let_go();
  point_at(mouse_in_widget(*event), event->modifiers());
}

void SliceView::mouseDoubleClickEvent(QMouseEvent* event) {
  if (event->button() == Qt::LeftButton && plane()) fit();
}

void SliceView::let_go() {
  grip_ = Grip{};
  look_again();
}

void SliceView::give_up() {
  switch (grip_.gesture) {
    case Gesture::none:
      break;
    case Gesture::crosshair:
      state_.set_crosshair(grip_.crosshair_mm);
      break;
    case Gesture::end:
      grip_.end->give_up();
      break;
    case Gesture::pan:
      view_ = grip_.view;
      break;
    case Gesture::window:
      state_.set_window(grip_.window);
      break;
  }
  let_go();
}

void SliceView::wheelEvent(QWheelEvent* event) {
  event->accept();
  if (grip_.gesture != Gesture::none || !plane()) return;
  // Alt, and Shift on some systems, turn the wheel's direction.
  const QPoint turned = event->angleDelta();
  const int delta = turned.y() != 0 ? turned.y() : turned.x();
  if (event->modifiers().testFlag(Qt::ControlModifier)) {
    zoom(std::pow(kZoomPerNotch, static_cast<double>(delta) / kNotch), event->position());
  } else {
    wheel_rest_ += delta;
    const int notches = wheel_rest_ / kNotch;
    wheel_rest_ -= notches * kNotch;
    step(notches * times_with_shift(event->modifiers()));
  }
  point_at(event->position(), event->modifiers());
}

void SliceView::leaveEvent(QEvent* /*event*/) {
  hot_.reset();
  wheel_rest_ = 0;
  state_.set_hovered(std::nullopt);
  update();
}

void SliceView::point_at(const QPointF& place, Qt::KeyboardModifiers keys) {
  const auto before = hot_;
  hot_.reset();
  std::optional<Vec3> p_mm;
  if (plane() && rect().contains(place.toPoint())) {
    p_mm = position_at(place);
    if (!is_in_grid(document_.opened()->ct.geometry, *p_mm)) p_mm.reset();
    hot_ = hit_path(frame(), devicePixelRatioF(), document_.paths(), document_.chosen(), place);
  }
  if (hot_ != before) update();
  state_.set_hovered(p_mm);
  update_cursor(keys);
}

void SliceView::update_cursor(Qt::KeyboardModifiers keys) {
  const auto shape = [&] {
    if (!plane()) return Qt::ArrowCursor;
    switch (grip_.gesture) {
      case Gesture::crosshair:
        return Qt::CrossCursor;
      case Gesture::end:
      case Gesture::pan:
        return Qt::ClosedHandCursor;
      case Gesture::window:
        return Qt::SizeAllCursor;
      case Gesture::none:
        break;
    }
    if (keys.testFlag(Qt::ShiftModifier)) return Qt::OpenHandCursor;
    if (hot_ && hot_->path != document_.chosen()) return Qt::PointingHandCursor;
    return hot_ && hot_->end ? Qt::OpenHandCursor : Qt::CrossCursor;
  };
  setCursor(shape());
}

bool SliceView::nudge(QKeyEvent* event) {
  const auto way = way_of_arrow(event->key());
  const bool with_ctrl = event->modifiers().testFlag(Qt::ControlModifier);
  const bool with_alt = event->modifiers().testFlag(Qt::AltModifier);
  if (!way || with_ctrl == with_alt) return false;
  const DrillPath* path = document_.chosen_path();
  if (path == nullptr || !plane() || grip_.gesture != Gesture::none) return true;
  // A key that is held is one step of undo.
  if (!event->isAutoRepeat() || nudge_drag_ == 0) nudge_drag_ = document_.new_drag();
  constexpr double kNudgeMm = 0.1;
  const SliceFrame shown = frame();
  const Vec3 step_mm =
      kNudgeMm * times_with_shift(event->modifiers()) * (way->x() * shown.right + way->y() * shown.down);
  const PathEnd end = with_ctrl ? PathEnd::entry : PathEnd::target;
  document_.move_end(document_.chosen(), end, (with_ctrl ? path->entry_mm : path->target_mm) + step_mm, nudge_drag_);
  return true;
}

void SliceView::keyPressEvent(QKeyEvent* event) {
  const QPointF middle(0.5 * (width() - 1), 0.5 * (height() - 1));
  if (nudge(event)) return;
  const bool is_plain = !(event->modifiers() & (Qt::ControlModifier | Qt::AltModifier | Qt::MetaModifier));
  switch (is_plain ? event->key() : 0) {
    case Qt::Key_Up:
    case Qt::Key_PageUp:
      return step(times_with_shift(event->modifiers()));
    case Qt::Key_Down:
    case Qt::Key_PageDown:
      return step(-times_with_shift(event->modifiers()));
    case Qt::Key_Plus:
    case Qt::Key_Equal:
      return zoom(kZoomPerNotch, middle);
    case Qt::Key_Minus:
      return zoom(1.0 / kZoomPerNotch, middle);
    case Qt::Key_0:
      return fit();
    case Qt::Key_Escape:
      if (grip_.gesture != Gesture::none) return give_up();
      break;
    default:
      break;
  }
  update_cursor(event->modifiers());
  QWidget::keyPressEvent(event);
}

void SliceView::keyReleaseEvent(QKeyEvent* event) {
  update_cursor(event->modifiers());
  QWidget::keyReleaseEvent(event);
}

void SliceView::focusInEvent(QFocusEvent* /*event*/) { update(); }

void SliceView::focusOutEvent(QFocusEvent* /*event*/) { update(); }

}  // namespace spinaltap
