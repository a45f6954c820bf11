#pragma once

#include <QLabel>

namespace spinaltap {

inline constexpr int kMaxElidedPx = 320;

/// One line of text, no wider than kMaxElidedPx, that gives way: of what does not fit the middle is left out. All of it
/// is the tool tip.
class ElidedLabel : public QLabel {
  Q_OBJECT
 public:
  using QLabel::QLabel;

  void set_text(const QString& text);

 protected:
  void resizeEvent(QResizeEvent* event) override;
  QSize sizeHint() const override;
  QSize minimumSizeHint() const override;

 private:
  void elide();

  QString text_;
};

}  // namespace spinaltap
