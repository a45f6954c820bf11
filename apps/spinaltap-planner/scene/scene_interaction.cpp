#include "apps/spinaltap-planner/scene/scene_interaction.h"

#include <QEvent>
#include <QKeyEvent>
#include <QMouseEvent>
#include <QWheelEvent>
#include <QWidget>
#include <array>
#include <cmath>

#include "apps/spinaltap-planner/scene/scene_pick.h"
#include "apps/spinaltap-planner/window/mouse_place.h"

namespace spinaltap {
namespace {

constexpr double kTurnPerPixel = 0.45 * kDegree;
constexpr double kTurnPerKey = 10.0 * kDegree;
constexpr double kZoomPerPixel = 1.006;
constexpr double kSceneZoomPerNotch = 1.15;

Eigen::Vector2d pixel_of(const QMouseEvent& event) { return {mouse_in_widget(event).x(), mouse_in_widget(event).y()}; }

}  // namespace

SceneInteraction::SceneInteraction(QWidget& pane, SceneCamera& camera, PlanDocument& document, ViewState& state)
    : pane_(pane), camera_(camera), document_(document), state_(state) {
  pane_.setMouseTracking(true);
  pane_.setFocusPolicy(Qt::StrongFocus);
  pane_.installEventFilter(this);
  connect(&document_, &PlanDocument::paths_changed, this, &SceneInteraction::forget_gone_paths);
}

bool SceneInteraction::eventFilter(QObject* pane, QEvent* event) {
  if (pane != &pane_ || document_.bone() == nullptr) return false;
  switch (event->type()) {
    case QEvent::MouseButtonPress:
      press(static_cast<const QMouseEvent&>(*event));
      return true;
    case QEvent::MouseMove:
      move(static_cast<const QMouseEvent&>(*event));
      return true;
    case QEvent::MouseButtonRelease:
      release(static_cast<const QMouseEvent&>(*event));
      return true;
    case QEvent::MouseButtonDblClick:
      double_click(static_cast<const QMouseEvent&>(*event));
      return true;
    case QEvent::Wheel:
      wheel(static_cast<const QWheelEvent&>(*event));
      return true;
    case QEvent::Leave:
      if (drag_ == Drag::none) set_hot(std::nullopt);
      return false;
    case QEvent::KeyPress:
      return press_key(static_cast<const QKeyEvent&>(*event));
    default:
      return false;
  }
}

void SceneInteraction::offer_handles(bool are_offered) {
  offers_handles_ = are_offered;
  if (are_offered) return;
  if (drag_ == Drag::handle) end_drag();
  set_hot(std::nullopt);
}

std::optional<PathHandle> SceneInteraction::under(const Eigen::Vector2d& pixel) const {
  if (!offers_handles_) return std::nullopt;
  return handle_at(document_.paths(), document_.chosen(), camera_, pixel);
}

void SceneInteraction::press(const QMouseEvent& event) {
  if (drag_ != Drag::none) return;
  const Eigen::Vector2d pixel = pixel_of(event);
  pressed_ = last_ = pixel;
  button_ = event.button();
  is_click_ = true;
  if (button_ == Qt::MiddleButton || (button_ == Qt::LeftButton && (event.modifiers() & Qt::ShiftModifier) != 0U)) {
    drag_ = Drag::pan;
  } else if (button_ == Qt::RightButton) {
    drag_ = Drag::zoom;
  } else if (button_ == Qt::LeftButton) {
    const auto handle = under(pixel);
    drag_ = handle ? Drag::handle : Drag::orbit;
    if (handle) take_hold(*handle, pixel);
  }
}

void SceneInteraction::move(const QMouseEvent& event) {
  constexpr double kClickPixels = 3.0;
  const Eigen::Vector2d pixel = pixel_of(event);
  if (drag_ == Drag::none) {
    set_hot(under(pixel));
    return;
  }
  if (is_click_ && (pixel - pressed_).norm() < kClickPixels) return;
  is_click_ = false;
  const Eigen::Vector2d way = pixel - last_;
  last_ = pixel;
  switch (drag_) {
    case Drag::none:
      break;
    case Drag::orbit:
      camera_.orbit(kTurnPerPixel * way.x(), -kTurnPerPixel * way.y());
      Q_EMIT camera_changed();
      break;
    case Drag::pan:
      camera_.pan(way);
      Q_EMIT camera_changed();
      break;
    case Drag::zoom:
      camera_.zoom(std::pow(kZoomPerPixel, -way.y()));
      Q_EMIT camera_changed();
      break;
    case Drag::handle:
      drag_handle(pixel);
      break;
  }
}

void SceneInteraction::release(const QMouseEvent& event) {
  if (event.button() != button_ || drag_ == Drag::none) return;
  const bool was_left_click = is_click_ && button_ == Qt::LeftButton && drag_ == Drag::orbit;
  end_drag();
  button_ = Qt::NoButton;
  const Eigen::Vector2d pixel = pixel_of(event);
  if (was_left_click) {
    const int path = path_at(document_.paths(), camera_, pixel);
    if (path >= 0) document_.choose(path);
  }
  set_hot(under(pixel));
  pane_.setCursor(hot_ ? Qt::OpenHandCursor : Qt::ArrowCursor);
}

void SceneInteraction::double_click(const QMouseEvent& event) {
  if (event.button() != Qt::LeftButton) return;
  const auto place = first_surface_mm(document_.bone()->model(), camera_.eye_mm(), camera_.ray(pixel_of(event)));
  if (place) state_.set_crosshair(*place);
}

void SceneInteraction::wheel(const QWheelEvent& event) {
  constexpr double kNotch = 120.0;
  camera_.zoom(std::pow(kSceneZoomPerNotch, event.angleDelta().y() / kNotch));
  Q_EMIT camera_changed();
}

bool SceneInteraction::press_key(const QKeyEvent& event) {
  static const std::array<QString, 7> kViews{"behind", "front", "left", "right", "above", "below", "hole"};
  const int key = event.key();
  if (key >= Qt::Key_1 && key <= Qt::Key_7) {
    Q_EMIT view_asked(kViews[static_cast<std::size_t>(key - Qt::Key_1)]);
    return true;
  }
  switch (key) {
    case Qt::Key_Escape:
      if (drag_ != Drag::handle) return false;
      put_back();
      return true;
    case Qt::Key_R:
      Q_EMIT view_asked({});
      return true;
    case Qt::Key_Left:
      camera_.orbit(-kTurnPerKey, 0.0);
      break;
    case Qt::Key_Right:
      camera_.orbit(kTurnPerKey, 0.0);
      break;
    case Qt::Key_Up:
      camera_.orbit(0.0, kTurnPerKey);
      break;
    case Qt::Key_Down:
      camera_.orbit(0.0, -kTurnPerKey);
      break;
    case Qt::Key_Plus:
    case Qt::Key_Equal:
      camera_.zoom(kSceneZoomPerNotch);
      break;
    case Qt::Key_Minus:
      camera_.zoom(1.0 / kSceneZoomPerNotch);
      break;
    default:
      return false;
  }
  Q_EMIT camera_changed();
  return true;
}

void SceneInteraction::take_hold(const PathHandle& handle, const Eigen::Vector2d& pixel) {
  constexpr double kHiddenMm = 2.0;
  document_.choose(handle.path);
  const DrillPath& path = *document_.chosen_path();
  const Vec3 place_mm = place_of(path, handle.end);
  held_ = {};
  held_.from_pointer = camera_.to_pixel(place_mm) - pixel;
  held_.depth_mm = camera_.depth_mm(place_mm);
  held_.before = path;
  held_.drag = document_.new_drag();
  const Vec3 eye_mm = camera_.eye_mm();
  const auto seen = first_surface_mm(document_.bone()->model(), eye_mm, (place_mm - eye_mm).normalized());
  held_.is_hidden = seen && (*seen - eye_mm).norm() < (place_mm - eye_mm).norm() - kHiddenMm;
  set_hot(handle);
  pane_.setCursor(Qt::ClosedHandCursor);
}

void SceneInteraction::drag_handle(const Eigen::Vector2d& pixel) {
  const Eigen::Vector2d aim = pixel + held_.from_pointer;
  // Beside the bone, and on a side that bone hides, the entry goes along in its plane and from there to the surface.
  Vec3 place_mm = camera_.at_depth(aim, held_.depth_mm);
  if (hot_->end == PathEnd::entry && !held_.is_hidden) {
    const auto seen = first_surface_mm(document_.bone()->model(), camera_.eye_mm(), camera_.ray(aim));
    if (seen) place_mm = *seen;
  }
  document_.move_end(hot_->path, hot_->end, place_mm, held_.drag);
}

void SceneInteraction::put_back() {
  end_drag();
  pane_.setCursor(Qt::ArrowCursor);
  document_.give_up(held_.drag);
  set_hot(std::nullopt);
}

void SceneInteraction::end_drag() {
  if (drag_ == Drag::none) return;
  drag_ = Drag::none;
  Q_EMIT drag_ended();
}

void SceneInteraction::set_hot(const std::optional<PathHandle>& hot) {
  if (hot == hot_) return;
  hot_ = hot;
  if (drag_ == Drag::none) pane_.setCursor(hot_ ? Qt::OpenHandCursor : Qt::ArrowCursor);
  Q_EMIT hot_changed();
}

void SceneInteraction::forget_gone_paths() {
  if (!hot_ || hot_->path < static_cast<int>(document_.paths().size())) return;
  end_drag();
  set_hot(std::nullopt);
}

}  // namespace spinaltap
