#pragma once

#include <QApplication>
#include <QElapsedTimer>
#include <QEvent>
#include <QWidget>
#include <algorithm>
#include <functional>
#include <vector>

#include "tests/gui/x_input.h"

namespace spinaltap::test {

/// Counts how often a widget, or one inside it, was painted.
class FrameWatch : public QObject {
 public:
  explicit FrameWatch(QWidget& widget) {
    watched_.push_back(&widget);
    for (QWidget* part : widget.findChildren<QWidget*>()) watched_.push_back(part);
    for (QObject* part : watched_) part->installEventFilter(this);
  }
  ~FrameWatch() override {
    for (QObject* part : watched_) part->removeEventFilter(this);
  }
  FrameWatch(const FrameWatch&) = delete;
  FrameWatch& operator=(const FrameWatch&) = delete;

  int frames() const { return frames_; }
  /// From doing something until the next frame has been painted, ms.
  double ms_to_next_frame(const std::function<void()>& work) {
    QElapsedTimer clock;
    const int before = frames_;
    clock.start();
    work();
    wait_until([&] { return frames_ > before; }, 2000);
    return static_cast<double>(clock.nsecsElapsed()) * 1e-6;
  }

 protected:
  bool eventFilter(QObject* object, QEvent* event) override {
    if (event->type() == QEvent::Paint) ++frames_;
    return QObject::eventFilter(object, event);
  }

 private:
  std::vector<QObject*> watched_;
  int frames_ = 0;
};

inline double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

}  // namespace spinaltap::test
