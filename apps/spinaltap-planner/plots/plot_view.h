#pragma once

#include <QPixmap>
#include <QString>
#include <QWidget>
#include <optional>

#include "apps/report/svg_plot.h"

namespace spinaltap {

/// A plot as reports draw it, as large as the widget; under the pointer the values there.
class PlotView : public QWidget {
  Q_OBJECT
 public:
  explicit PlotView(QWidget* parent = nullptr);

  /// Its width and height become the widget's. Throws Error as svg_plot() does.
  void set_plot(Plot plot);
  /// What is said while there is nothing to show.
  void set_hint(const QString& hint);
  const Plot& plot() const { return plot_; }
  /// What the pointer is told at a place along x, in the widget's pixels: "depth 12.0 mm, thrust 14.2 N"; empty beside
  /// the curves.
  QString values_at(double x_pixel) const;

  QSize sizeHint() const override { return {360, 190}; }
  QSize minimumSizeHint() const override { return {220, 140}; }

 protected:
  void paintEvent(QPaintEvent* event) override;
  void resizeEvent(QResizeEvent* event) override;
  void mouseMoveEvent(QMouseEvent* event) override;
  void leaveEvent(QEvent* event) override;

 private:
  bool is_empty() const;
  void draw_plot();

  Plot plot_;
  QString hint_;
  QPixmap picture_;  ///< of the plot; null: to be drawn
  std::optional<double> pointer_x_;
};

}  // namespace spinaltap
