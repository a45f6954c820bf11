#pragma once

#include <QObject>

namespace spinaltap {

/// Numbers, lists and sliders turn by the wheel only where they have the keyboard: a page that is scrolled with the
/// pointer over them changes no plan. The wheel scrolls the page instead. For all widgets of the program, while it
/// lives.
class WheelNeedsFocus final : public QObject {
 public:
  explicit WheelNeedsFocus(QObject* parent);
  bool eventFilter(QObject* object, QEvent* event) override;
};

}  // namespace spinaltap
