#include "apps/spinaltap-planner/slices/pane_marks.h"

#include <QFontMetricsF>
#include <QPainter>
#include <array>
#include <cmath>

#include "apps/spinaltap-planner/colours.h"
#include "apps/spinaltap-planner/slices/haloed.h"
#include "apps/spinaltap-planner/slices/pane_geometry.h"

namespace spinaltap {
namespace {

constexpr double kEdgePx = 8.0;   ///< between words and the pane's edge
constexpr double kWordsPt = 9.5;  ///< size of words
constexpr double kLettersPt = 12.0;

Eigen::AlignedBox2d box_of(const QRectF& r) {
  return {Eigen::Vector2d(r.left(), r.top()), Eigen::Vector2d(r.right(), r.bottom())};
}

void paint_words(QPainter& painter, const QPointF& place, TextAnchor anchor, const QString& text, LabelPlacer& labels,
                 const QColor& colour = QColor(kTextRgb)) {
  draw_haloed_text(painter, place, anchor, text, colour);
  const QFontMetricsF metrics(painter.font());
  const double width = metrics.horizontalAdvance(text);
  const double left = place.x() - (anchor == TextAnchor::left     ? 0.0
                                   : anchor == TextAnchor::middle ? 0.5 * width
                                                                  : width);
  labels.avoid(box_of({left, place.y() - 0.5 * metrics.height(), width, metrics.height()}));
}

void paint_letters(QPainter& painter, const PaneScene& scene, LabelPlacer& labels) {
  set_text_size(painter, kLettersPt, true);
  const QSizeF size = scene.size();
  const double half = 0.5 * QFontMetricsF(painter.font()).height();
  const auto letters = [](const Vec3& direction) { return QString::fromStdString(orientation_letters(direction)); };
  const Vec3& right = scene.frame.right;
  const Vec3& down = scene.frame.down;
  paint_words(painter, {kEdgePx, 0.5 * size.height()}, TextAnchor::left, letters(-right), labels);
  paint_words(painter, {size.width() - kEdgePx, 0.5 * size.height()}, TextAnchor::right, letters(right), labels);
  paint_words(painter, {0.5 * size.width(), kEdgePx + half - 2.0}, TextAnchor::middle, letters(-down), labels);
  paint_words(painter, {0.5 * size.width(), size.height() - kEdgePx - half + 2.0}, TextAnchor::middle, letters(down),
              labels);
}

void paint_scale_bar(QPainter& painter, const PaneScene& scene, LabelPlacer& labels) {
  const QSizeF size = scene.size();
  const double mm_per_px = scene.frame.pixel_mm * scene.ratio;
  const double bar_mm = scale_bar_mm(mm_per_px, 0.22 * size.width());
  const double right = std::round(size.width() - kEdgePx - 2.0) + 0.5;
  const double left = right - bar_mm / mm_per_px;
  const double y = std::round(size.height() - kEdgePx - 2.0) + 0.5;
  constexpr double kTickPx = 4.0;
  const QPen pen(QColor(kTextRgb), 1.5);
  draw_haloed_line(painter, {left, y}, {right, y}, pen);
  draw_haloed_line(painter, {left, y - kTickPx}, {left, y + 1.0}, pen);
  draw_haloed_line(painter, {right, y - kTickPx}, {right, y + 1.0}, pen);
  const double text_y = y - 0.5 * QFontMetricsF(painter.font()).height() - 2.0;
  paint_words(painter, {0.5 * (left + right), text_y}, TextAnchor::middle, QString("%1 mm").arg(bar_mm), labels);
  labels.avoid(box_of({left, y - kTickPx, right - left, 2.0 * kTickPx}));
}

}  // namespace

void paint_crosshair(QPainter& painter, const PaneScene& scene) {
  constexpr double kGapPx = 14.0;
  const QPointF middle = scene.drawn(scene.crosshair_mm);
  const double far_px = scene.size().width() + scene.size().height();
  for (const Plane plane : {Plane::kAxial, Plane::kCoronal, Plane::kSagittal}) {
    // A plane that hardly cuts this one has no line worth drawing.
    const Vec3 along = scene.frame.into().cross(standard_plane(plane, Vec3::Zero()).into());
    if (along.norm() < 0.5) continue;
    const QPointF way(along.normalized().dot(scene.frame.right), along.normalized().dot(scene.frame.down));
    // Upright and level lines are sharpest on whole pixels.
    painter.setRenderHint(QPainter::Antialiasing, std::min(std::abs(way.x()), std::abs(way.y())) > 1e-6);
    QColor colour = plane_colour(plane);
    colour.setAlphaF(0.85F);
    for (const double side : {-1.0, 1.0}) {
      draw_haloed_line(painter, middle + side * kGapPx * way, middle + side * far_px * way, QPen(colour, 1.0));
    }
  }
  painter.setRenderHint(QPainter::Antialiasing);
}

void paint_pane_words(QPainter& painter, const PaneScene& scene, const QString& caption, const QColor& colour,
                      const HuWindow& window, LabelPlacer& labels) {
  paint_letters(painter, scene, labels);
  set_text_size(painter, kWordsPt, true);
  const double half = 0.5 * QFontMetricsF(painter.font()).height();
  paint_words(painter, {kEdgePx, kEdgePx + half}, TextAnchor::left, caption, labels, colour);
  set_text_size(painter, kWordsPt, false);
  const QString words = QString("W %1  L %2 HU").arg(std::lround(window.width_hu)).arg(std::lround(window.level_hu));
  paint_words(painter, {kEdgePx, scene.size().height() - kEdgePx - half}, TextAnchor::left, words, labels);
  paint_scale_bar(painter, scene, labels);
}

void paint_level_names(QPainter& painter, const PaneScene& scene, const std::vector<SliceName>& names,
                       LabelPlacer& labels) {
  set_text_size(painter, kWordsPt, true);
  for (const SliceName& name : names) {
    const Eigen::Vector2d at = scene.in_logical(name.right);
    const double width = QFontMetricsF(painter.font()).horizontalAdvance(name.text);
    // Where the bone begins beyond the pane's edge, on it.
    const QPointF right(std::max(at.x(), kEdgePx + width), at.y());
    paint_words(painter, right, TextAnchor::right, name.text, labels, name.colour);
  }
}

void paint_pane_edge(QPainter& painter, const QSizeF& size, const QColor& colour, bool has_focus) {
  const double width = has_focus ? 3.0 : 1.0;
  QColor shown = colour;
  shown.setAlphaF(has_focus ? 1.0F : 0.45F);
  painter.setBrush(Qt::NoBrush);
  painter.setPen(QPen(shown, width, Qt::SolidLine, Qt::SquareCap, Qt::MiterJoin));
  painter.drawRect(QRectF(0.5 * width, 0.5 * width, size.width() - width, size.height() - width));
}

void paint_empty_pane(QPainter& painter, const QSizeF& size, const QString& caption, const QColor& colour,
                      const QString& hint) {
  painter.fillRect(QRectF(QPointF(0.0, 0.0), size), QColor(kEmptyRgb));
  set_text_size(painter, kWordsPt, true);
  const double half = 0.5 * QFontMetricsF(painter.font()).height();
  draw_haloed_text(painter, {kEdgePx, kEdgePx + half}, TextAnchor::left, caption, colour);
  set_text_size(painter, 11.0, false);
  painter.setPen(QColor(0xb0, 0xb8, 0xbe));
  const QRectF room(16.0, 32.0, std::max(1.0, size.width() - 32.0), std::max(1.0, size.height() - 64.0));
  painter.drawText(room, Qt::AlignCenter | Qt::TextWordWrap, hint);
}

}  // namespace spinaltap
