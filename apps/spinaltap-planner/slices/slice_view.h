#pragma once

#include <QWidget>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "apps/spinaltap-planner/plan_document.h"
#include "apps/spinaltap-planner/slices/hole_walls.h"
#include "apps/spinaltap-planner/slices/pane_geometry.h"
#include "apps/spinaltap-planner/slices/path_hits.h"
#include "apps/spinaltap-planner/slices/slice_image.h"
#include "apps/spinaltap-planner/view_state.h"

namespace spinaltap {

/// What a pane shows: a standard plane through the crosshair, or the plane across the chosen path.
enum class SliceKind { axial, coronal, sagittal, down_path };

/// A slice of the CT with the plan drawn over it, in which the plan is changed by hand.
///
/// Mouse: left puts the crosshair, takes an end of the chosen path by its handle, or chooses another path; middle, or
/// Shift and left, moves the picture; right changes the HU window; the wheel steps slices (Shift: ten), with Ctrl it
/// zooms about the pointer; a double click fits. Escape gives up what the mouse is doing.
///
/// Keys: Up and Page Up step a slice away from the viewer, Down and Page Down towards the viewer; + and - zoom, 0 fits;
/// Ctrl and an arrow move the chosen path's entry by 0.1 mm in the slice's plane, Alt and an arrow its target. With
/// Shift all steps are ten times as large.
class SliceView : public QWidget {
  Q_OBJECT
 public:
  /// `document` and `state` must outlive it.
  SliceView(SliceKind kind, PlanDocument& document, ViewState& state, QWidget* parent = nullptr);
  ~SliceView() override;

  SliceKind kind() const { return kind_; }
  /// The bit while it drills; nothing: the path's own bit is drawn, its tip at the target. One that is no bit, or lies
  /// nowhere, is not drawn.
  void set_bit(const std::optional<std::pair<DrillBit, Pose>>& bit);

  /// Blocks of the bone's surface that drilling changed (null surface: none left there); their drilled walls are drawn.
  void update_surface(std::span<const SurfaceUpdate> updates);

  /// Where the pane's device pixels lie in the patient.
  SliceFrame frame() const;
  /// Where a patient position (mm) lies in the pane, as mouse events count; its distance from the slice is left out.
  QPointF place_of(const Vec3& p_mm) const;
  /// The patient position (mm) on the slice under a place of the pane.
  Vec3 position_at(const QPointF& place) const;
  /// The plane's name and place, in words.
  QString caption() const;

  /// Away from the viewer (below 0: towards): slices of the CT, or steps of 0.25 mm down the path.
  void step(int count);
  /// Shows the bone, without one the CT, as large as the pane allows.
  void fit();
  /// Shows a box (patient LPS, mm) so.
  void fit_to(const Box3& shown_mm);
  /// About a place of the pane.
  void zoom(double factor, const QPointF& place);

  QSize sizeHint() const override { return {480, 360}; }
  QSize minimumSizeHint() const override { return {140, 110}; }

 protected:
  void paintEvent(QPaintEvent* event) override;
  void resizeEvent(QResizeEvent* event) override;
  void mousePressEvent(QMouseEvent* event) override;
  void mouseMoveEvent(QMouseEvent* event) override;
  void mouseReleaseEvent(QMouseEvent* event) override;
  void mouseDoubleClickEvent(QMouseEvent* event) override;
  void wheelEvent(QWheelEvent* event) override;
  void leaveEvent(QEvent* event) override;
  void keyPressEvent(QKeyEvent* event) override;
  void keyReleaseEvent(QKeyEvent* event) override;
  void focusInEvent(QFocusEvent* event) override;
  void focusOutEvent(QFocusEvent* event) override;

 private:
  enum class Gesture { none, crosshair, end, pan, window };
  /// What a pressed button is doing, and how all was before.
  struct Grip {
    Gesture gesture = Gesture::none;
    Qt::MouseButton button = Qt::NoButton;
    QPointF pressed;
    PaneView view;
    HuWindow window;
    Vec3 crosshair_mm = Vec3::Zero();
    std::optional<PanePlane> plane;  ///< that a drag of an end stays in, though the path turns
    std::optional<EndDrag> end;
  };

  bool has_ct() const;
  Vec3 shown_crosshair() const;
  std::optional<PanePlane> plane() const;
  PaneSize pane_size() const;
  void put_crosshair(const Vec3& p_mm);
  void follow_crosshair();
  void look_again();

  Gesture gesture_of(Qt::MouseButton button, Qt::KeyboardModifiers keys, const QPointF& place);
  void go_on(const QPointF& place);
  void give_up();
  void let_go();
  void point_at(const QPointF& place, Qt::KeyboardModifiers keys);
  void update_cursor(Qt::KeyboardModifiers keys);
  bool nudge(QKeyEvent* event);

  SliceKind kind_;
  PlanDocument& document_;
  ViewState& state_;
  std::optional<std::pair<DrillBit, Pose>> bit_;
  HoleWalls walls_;
  PaneView view_;
  bool is_fitted_ = true;                    ///< and stays so when the pane's size changes
  std::weak_ptr<const CtVolume> fitted_ct_;  ///< the last that was shown
  double depth_mm_ = 0.0;                    ///< down the path
  bool is_putting_crosshair_ = false;
  Grip grip_;
  std::optional<PathHit> hot_;
  int wheel_rest_ = 0;  ///< eighths of a degree that make no whole step yet
  std::uint64_t nudge_drag_ = 0;
  SliceImage image_;
};

}  // namespace spinaltap
