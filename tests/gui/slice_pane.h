#pragma once

#include <gmock/gmock.h>

#include <QApplication>
#include <QImage>
#include <QKeyEvent>
#include <QMouseEvent>
#include <QWheelEvent>
#include <memory>

#include "apps/spinaltap-planner/slices/slice_view.h"
#include "tests/gui/phantom_bone.h"

namespace spinaltap {

inline constexpr double kRounding = 1e-9;  // mm, at places of some ten

inline QImage picture_of(SliceView& view) { return view.grab().toImage().convertToFormat(QImage::Format_RGB32); }

/// A pane of 700 x 450 pixels over the phantom with its two paths, the left one chosen, the crosshair in its middle.
class SlicePane : public testing::Test {
 protected:
  SlicePane() {
    document_.set_bone(test::phantom_bone());
    document_.set_paths(test::phantom_paths());
    state_.set_crosshair(middle_mm());
  }

  SliceView& open(SliceKind kind) {
    view_ = std::make_unique<SliceView>(kind, document_, state_);
    view_->resize(700, 450);
    view_->show();
    QApplication::processEvents();
    return *view_;
  }

  const DrillPath& path() const { return document_.paths().front(); }
  Vec3 middle_mm() const { return 0.5 * (path().entry_mm + path().target_mm); }
  /// On no path and no handle.
  QPointF free_place() const { return view_->place_of(middle_mm()) + QPointF(60.0, 40.0); }

  void mouse(QEvent::Type type, const QPointF& at, Qt::MouseButton button = Qt::LeftButton,
             Qt::KeyboardModifiers keys = Qt::NoModifier) {
    const bool is_down = type != QEvent::MouseButtonRelease;
    QMouseEvent event(type, at, at, at, type == QEvent::MouseMove ? Qt::NoButton : button,
                      is_down ? Qt::MouseButtons(button) : Qt::NoButton, keys);
    QApplication::sendEvent(view_.get(), &event);
  }
  void press(const QPointF& at, Qt::MouseButton button = Qt::LeftButton, Qt::KeyboardModifiers keys = Qt::NoModifier) {
    mouse(QEvent::MouseButtonPress, at, button, keys);
  }
  /// From press to release, in four moves.
  void drag(const QPointF& from, const QPointF& by, Qt::MouseButton button = Qt::LeftButton,
            Qt::KeyboardModifiers keys = Qt::NoModifier) {
    press(from, button, keys);
    for (int n = 1; n <= 4; ++n) mouse(QEvent::MouseMove, from + 0.25 * n * by, button, keys);
    mouse(QEvent::MouseButtonRelease, from + by, button, keys);
  }
  void wheel(const QPointF& at, int notches, Qt::KeyboardModifiers keys = Qt::NoModifier) {
    QWheelEvent event(at, at, QPoint(), QPoint(0, 120 * notches), Qt::NoButton, keys, Qt::NoScrollPhase, false);
    QApplication::sendEvent(view_.get(), &event);
  }
  void key(int code, Qt::KeyboardModifiers keys = Qt::NoModifier) {
    QKeyEvent event(QEvent::KeyPress, code, keys);
    QApplication::sendEvent(view_.get(), &event);
  }

  QImage picture() { return picture_of(*view_); }

  PlanDocument document_;
  ViewState state_;
  std::unique_ptr<SliceView> view_;
};

}  // namespace spinaltap
