#include "apps/planner/slices/haloed.h"

#include <QFontMetricsF>
#include <QPainter>
#include <QPainterPath>
#include <cmath>

namespace spinaltap {
namespace {

QPen halo_of(const QPen& pen) {
  constexpr double kMorePx = 2.0;
  QPen halo(QColor(0, 0, 0, pen.color().alpha() * 3 / 5));
  halo.setWidthF(pen.widthF() + kMorePx);
  halo.setCapStyle(Qt::FlatCap);
  halo.setJoinStyle(Qt::RoundJoin);
  return halo;
}

}  // namespace

void draw_haloed_line(QPainter& painter, const QPointF& from, const QPointF& to, const QPen& pen) {
  painter.setPen(halo_of(pen));
  painter.drawLine(from, to);
  painter.setPen(pen);
  painter.drawLine(from, to);
}

void draw_haloed_polygon(QPainter& painter, const QPolygonF& polygon, const QPen& pen, const QColor& fill) {
  painter.setBrush(Qt::NoBrush);
  painter.setPen(halo_of(pen));
  painter.drawPolygon(polygon);
  painter.setBrush(fill);
  painter.setPen(pen);
  painter.drawPolygon(polygon);
  painter.setBrush(Qt::NoBrush);
}

void draw_haloed_text(QPainter& painter, const QPointF& place, TextAnchor anchor, const QString& text,
                      const QColor& colour) {
  const QFontMetricsF metrics(painter.font());
  const double width = metrics.horizontalAdvance(text);
  const double shift = anchor == TextAnchor::left ? 0.0 : anchor == TextAnchor::middle ? 0.5 * width : width;
  // Whole pixels keep the letters sharp.
  const QPointF start(std::round(place.x() - shift), std::round(place.y() + 0.5 * metrics.capHeight()));
  QPainterPath outline;
  outline.addText(start, painter.font(), text);
  painter.strokePath(outline,
                     QPen(QColor(0, 0, 0, colour.alpha() * 4 / 5), 3.0, Qt::SolidLine, Qt::RoundCap, Qt::RoundJoin));
  painter.setPen(colour);
  painter.drawText(start, text);
}

void set_text_size(QPainter& painter, double points, bool is_bold) {
  QFont font = painter.font();
  font.setPointSizeF(points);
  font.setBold(is_bold);
  painter.setFont(font);
}

}  // namespace spinaltap
