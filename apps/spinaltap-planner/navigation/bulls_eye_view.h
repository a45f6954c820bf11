#pragma once

#include <QSet>
#include <QWidget>
#include <memory>
#include <optional>

#include "apps/spinaltap-planner/navigation/desktop_device.h"
#include "apps/spinaltap-planner/navigation/navigation_figures.h"
#include "apps/spinaltap-planner/plan_document.h"
#include "apps/spinaltap-planner/slices/hole_walls.h"
#include "apps/spinaltap-planner/slices/pane_geometry.h"
#include "apps/spinaltap-planner/slices/slice_image.h"
#include "apps/spinaltap-planner/view_state.h"

namespace spinaltap {

/// The view down the bit: the CT across it at its tip, rings about its axis, and where the plan's entry (round) and
/// target (square) lie as seen along it. A tool that is on its path has both in the middle.
///
/// With a DesktopDevice it is the hand as well. Mouse: left drag moves the handle aside, right drag leans it over, the
/// wheel pushes by 0.25 mm and draws back. Keys: W and S push and draw back, the arrows move aside (2 mm/s; Shift: 8),
/// A, D, Q and E lean over; Space turns the spindle on and off; Escape ends.
class BullsEyeView : public QWidget {
  Q_OBJECT
 public:
  /// `document` and `state` must outlive it.
  BullsEyeView(PlanDocument& document, ViewState& state, QWidget* parent = nullptr);

  /// What the picture shows; nothing: no tool is there.
  void show_tool(const std::optional<NavigationFigures>& figures, const std::optional<DrillPath>& path);
  /// Null: mouse and keys do nothing.
  void set_device(std::shared_ptr<DesktopDevice> device);

  /// Where a place in the patient is drawn, as seen along the bit; the middle where there is no tool.
  QPointF place_of(const Vec3& p_mm) const;
  double mm_per_pixel() const;

  QSize sizeHint() const override { return {360, 360}; }
  QSize minimumSizeHint() const override { return {220, 220}; }

 protected:
  void paintEvent(QPaintEvent* event) override;
  void mousePressEvent(QMouseEvent* event) override;
  void mouseMoveEvent(QMouseEvent* event) override;
  void wheelEvent(QWheelEvent* event) override;
  void keyPressEvent(QKeyEvent* event) override;
  void keyReleaseEvent(QKeyEvent* event) override;
  void focusOutEvent(QFocusEvent* event) override;

 private:
  std::optional<PanePlane> plane() const;
  SliceFrame frame(const PanePlane& plane) const;
  void paint_marks(QPainter& painter, const SliceFrame& shown) const;
  void go_as_keys_say(bool is_fast);

  PlanDocument& document_;
  ViewState& state_;
  std::optional<NavigationFigures> figures_;
  std::optional<DrillPath> path_;
  std::shared_ptr<DesktopDevice> device_;
  QSet<int> held_;
  QPointF mouse_;
  SliceImage image_;
  HoleWalls no_walls_;
};

}  // namespace spinaltap
