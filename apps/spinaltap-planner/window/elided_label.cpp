#include "apps/spinaltap-planner/window/elided_label.h"

#include <algorithm>

namespace spinaltap {

void ElidedLabel::set_text(const QString& text) {
  if (text == text_) return;
  text_ = text;
  setToolTip(text);
  setAccessibleName(text);
  updateGeometry();
  elide();
}

void ElidedLabel::elide() { setText(fontMetrics().elidedText(text_, Qt::ElideMiddle, std::max(width(), 1))); }

void ElidedLabel::resizeEvent(QResizeEvent* event) {
  QLabel::resizeEvent(event);
  elide();
}

QSize ElidedLabel::sizeHint() const {
  constexpr int kSpare = 4;
  return {std::min(fontMetrics().horizontalAdvance(text_) + kSpare, kMaxElidedPx), QLabel::sizeHint().height()};
}

QSize ElidedLabel::minimumSizeHint() const {
  constexpr int kMinPx = 60;
  return {kMinPx, QLabel::minimumSizeHint().height()};
}

}  // namespace spinaltap
