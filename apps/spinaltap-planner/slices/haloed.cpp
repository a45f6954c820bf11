#include "apps/spinaltap-planner/slices/haloed.h"

#include <QFontMetricsF>
#include <QPainter>
#include <QPainterPath>
#include <QPixmapCache>
#include <array>
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
  draw_haloed_lines(painter, std::array{QLineF(from, to)}, pen);
}

void draw_haloed_lines(QPainter& painter, std::span<const QLineF> lines, const QPen& pen) {
  const int count = static_cast<int>(lines.size());
  painter.setPen(halo_of(pen));
  painter.drawLines(lines.data(), count);
  painter.setPen(pen);
  painter.drawLines(lines.data(), count);
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
  constexpr int kHaloPx = 3;
  const QFontMetricsF metrics(painter.font());
  const double width = metrics.horizontalAdvance(text);
  const double shift = anchor == TextAnchor::left ? 0.0 : anchor == TextAnchor::middle ? 0.5 * width : width;
  // Whole pixels keep the letters sharp.
  const QPointF start(std::round(place.x() - shift), std::round(place.y() + 0.5 * metrics.capHeight()));
  const QPointF in_picture(kHaloPx, std::ceil(metrics.ascent()) + kHaloPx);
  const double ratio = painter.device()->devicePixelRatioF();
  // The same words come frame after frame, and a halo takes long to draw.
  const QString key = QString("haloed %1 %2 %3 %4").arg(painter.font().key(), text).arg(colour.rgba()).arg(ratio);
  QPixmap picture;
  if (!QPixmapCache::find(key, &picture)) {
    const QSizeF size(std::ceil(width) + 2 * kHaloPx, std::ceil(metrics.height()) + 2 * kHaloPx);
    picture = QPixmap((size * ratio).toSize());
    picture.setDevicePixelRatio(ratio);
    picture.fill(Qt::transparent);
    QPainter words(&picture);
    words.setRenderHint(QPainter::Antialiasing);
    words.setFont(painter.font());
    QPainterPath outline;
    outline.addText(in_picture, painter.font(), text);
    words.strokePath(outline,
                     QPen(QColor(0, 0, 0, colour.alpha() * 4 / 5), 3.0, Qt::SolidLine, Qt::RoundCap, Qt::RoundJoin));
    words.setPen(colour);
    words.drawText(in_picture, text);
    words.end();
    QPixmapCache::insert(key, picture);
  }
  painter.drawPixmap(start - in_picture, picture);
}

void set_text_size(QPainter& painter, double points, bool is_bold) {
  QFont font = painter.font();
  font.setPointSizeF(points);
  font.setBold(is_bold);
  painter.setFont(font);
}

}  // namespace spinaltap
