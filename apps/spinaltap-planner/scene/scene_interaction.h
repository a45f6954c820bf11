#pragma once

#include <QObject>
#include <QPointF>
#include <cstdint>
#include <optional>

#include "apps/spinaltap-planner/plan_document.h"
#include "apps/spinaltap-planner/scene/scene_camera.h"
#include "apps/spinaltap-planner/scene/scene_pick.h"
#include "apps/spinaltap-planner/view_state.h"

class QKeyEvent;
class QMouseEvent;
class QWheelEvent;
class QWidget;

namespace spinaltap {

/// What pointer and keys do in the 3D pane. Left on a handle: moves that end of the path, Escape puts it back; left
/// elsewhere turns, middle or Shift and left moves, right or wheel zooms; a click chooses a path, a double click puts
/// the crosshair on the bone.
class SceneInteraction : public QObject {
  Q_OBJECT
 public:
  /// Takes the events of `pane`. All that is given must outlive this.
  SceneInteraction(QWidget& pane, SceneCamera& camera, PlanDocument& document, ViewState& state);

  /// Whether ends of paths can be taken hold of.
  void offer_handles(bool are_offered);
  /// Under the pointer, or held.
  const std::optional<PathHandle>& hot() const { return hot_; }
  /// Whether a button is held that turns, moves or zooms.
  bool is_dragging() const { return drag_ != Drag::none; }

 Q_SIGNALS:
  void camera_changed();
  void hot_changed();
  void drag_ended();
  /// A view as SceneView::look_from() has them; empty: all of the bone from where the eye is.
  void view_asked(const QString& name);

 protected:
  bool eventFilter(QObject* pane, QEvent* event) override;

 private:
  enum class Drag { none, orbit, pan, zoom, handle };

  std::optional<PathHandle> under(const Eigen::Vector2d& pixel) const;
  void press(const QMouseEvent& event);
  void move(const QMouseEvent& event);
  void release(const QMouseEvent& event);
  void double_click(const QMouseEvent& event);
  void wheel(const QWheelEvent& event);
  bool press_key(const QKeyEvent& event);

  void take_hold(const PathHandle& handle, const Eigen::Vector2d& pixel);
  void drag_handle(const Eigen::Vector2d& pixel);
  void put_back();
  void end_drag();
  void set_hot(const std::optional<PathHandle>& hot);
  void forget_gone_paths();

  QWidget& pane_;
  SceneCamera& camera_;
  PlanDocument& document_;
  ViewState& state_;
  bool offers_handles_ = true;
  std::optional<PathHandle> hot_;
  Drag drag_ = Drag::none;
  Qt::MouseButton button_ = Qt::NoButton;
  Eigen::Vector2d pressed_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d last_ = Eigen::Vector2d::Zero();
  bool is_click_ = false;  ///< the pointer has hardly moved since it was pressed

  /// Of a handle that is held.
  struct Held {
    Eigen::Vector2d from_pointer = Eigen::Vector2d::Zero();  ///< pixels, so that it does not jump under the pointer
    double depth_mm = 0.0;                                   ///< before the eye, when it was taken
    bool is_hidden = false;                                  ///< behind bone, when it was taken
    DrillPath before;
    std::uint64_t drag = 0;
  };
  Held held_;
};

}  // namespace spinaltap
