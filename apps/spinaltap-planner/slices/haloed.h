#pragma once

#include <QColor>
#include <QFont>
#include <QLineF>
#include <QPen>
#include <QPointF>
#include <QPolygonF>
#include <QString>
#include <span>

class QPainter;

namespace spinaltap {

/// Drawing that stays legible on black and on light grey: each over a wider dark copy of itself.
void draw_haloed_line(QPainter& painter, const QPointF& from, const QPointF& to, const QPen& pen);
void draw_haloed_lines(QPainter& painter, std::span<const QLineF> lines, const QPen& pen);
void draw_haloed_polygon(QPainter& painter, const QPolygonF& polygon, const QPen& pen, const QColor& fill);

/// Where a line of text stands around its place.
enum class TextAnchor { left, middle, right };
/// Its middle in height is at `place`.
void draw_haloed_text(QPainter& painter, const QPointF& place, TextAnchor anchor, const QString& text,
                      const QColor& colour);
/// The painter's font, `points` high.
void set_text_size(QPainter& painter, double points, bool is_bold);

}  // namespace spinaltap
