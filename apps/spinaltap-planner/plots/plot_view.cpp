#include "apps/spinaltap-planner/plots/plot_view.h"

#include <QByteArray>
#include <QMouseEvent>
#include <QPainter>
#include <QStringList>
#include <QSvgRenderer>
#include <QToolTip>
#include <algorithm>
#include <cmath>
#include <utility>

#include "apps/report/text.h"
#include "apps/spinaltap-planner/window/mouse_place.h"

namespace spinaltap {
namespace {

/// The series' value that is nearest along x; nothing where none is within `reach`.
std::optional<std::size_t> nearest_value(const PlotSeries& series, double x, double reach) {
  std::optional<std::size_t> nearest;
  for (std::size_t n = 0; n < series.x.size(); ++n) {
    const double off = std::abs(series.x[n] - x);
    if (!std::isfinite(series.y[n]) || !(off <= reach)) continue;
    reach = off;
    nearest = n;
  }
  return nearest;
}

QString quantity(const std::string& name, double value, const std::string& unit) {
  const double size = std::abs(value);
  const int digits = size < 10.0 ? 2 : size < 1000.0 ? 1 : 0;
  const std::string text = name + " " + readable_number(value, digits) + (unit.empty() ? "" : " " + unit);
  return QString::fromStdString(text);
}

}  // namespace

PlotView::PlotView(QWidget* parent) : QWidget(parent), hint_(tr("Nothing to show yet")) { setMouseTracking(true); }

void PlotView::set_plot(Plot plot) {
  plot_ = std::move(plot);
  plot_axes(plot_);  // what cannot be drawn is rejected here, not when it is painted
  setAccessibleName(QString::fromStdString(plot_.y_label + " over " + plot_.x_label));
  picture_ = {};
  update();
}

void PlotView::set_hint(const QString& hint) {
  hint_ = hint;
  update();
}

bool PlotView::is_empty() const {
  return std::none_of(plot_.series.begin(), plot_.series.end(), [](const PlotSeries& series) {
    return std::any_of(series.y.begin(), series.y.end(), [](double y) { return std::isfinite(y); });
  });
}

void PlotView::draw_plot() {
  plot_.width = width();
  plot_.height = height();
  picture_ = QPixmap(size() * devicePixelRatioF());
  picture_.setDevicePixelRatio(devicePixelRatioF());
  picture_.fill(Qt::white);
  QSvgRenderer renderer(QByteArray::fromStdString(svg_plot(plot_)));
  QPainter painter(&picture_);
  painter.setFont(font());
  renderer.render(&painter, QRectF(0.0, 0.0, width(), height()));
}

void PlotView::paintEvent(QPaintEvent* /*event*/) {
  QPainter painter(this);
  if (is_empty()) {
    painter.fillRect(rect(), Qt::white);
    painter.setPen(QColor(0x5b, 0x66, 0x70));
    painter.drawText(rect().adjusted(12, 12, -12, -12), Qt::AlignCenter | Qt::TextWordWrap, hint_);
    return;
  }
  if (picture_.isNull()) draw_plot();
  painter.drawPixmap(0, 0, picture_);
  if (!pointer_x_ || values_at(*pointer_x_).isEmpty()) return;
  const PlotAxes axes = plot_axes(plot_);
  painter.setPen(QPen(QColor(0x33, 0x3b, 0x42, 150), 1.0));
  painter.drawLine(QPointF(*pointer_x_, axes.y.from), QPointF(*pointer_x_, axes.y.to));
}

void PlotView::resizeEvent(QResizeEvent* /*event*/) {
  plot_.width = width();
  plot_.height = height();
  picture_ = {};
}

QString PlotView::values_at(double x_pixel) const {
  if (is_empty()) return {};
  const AxisScale axis = plot_axes(plot_).x;
  if (x_pixel < axis.from || x_pixel > axis.to) return {};
  const double x = axis.low + (x_pixel - axis.from) / (axis.to - axis.from) * (axis.high - axis.low);
  const double reach = 4.0 / (axis.to - axis.from) * (axis.high - axis.low);
  QStringList values;
  for (const PlotSeries& series : plot_.series) {
    const std::optional<std::size_t> n = nearest_value(series, x, reach);
    if (!n) continue;
    if (values.isEmpty()) values << quantity(plot_.x_label, series.x[*n], plot_.x_unit);
    values << quantity(series.name.empty() ? plot_.y_label : series.name, series.y[*n], plot_.y_unit);
  }
  return values.join(", ");
}

void PlotView::mouseMoveEvent(QMouseEvent* event) {
  pointer_x_ = mouse_in_widget(*event).x();
  QToolTip::showText(mouse_on_screen(*event), values_at(*pointer_x_), this);
  update();
}

void PlotView::leaveEvent(QEvent* /*event*/) {
  pointer_x_.reset();
  QToolTip::hideText();
  update();
}

}  // namespace spinaltap
