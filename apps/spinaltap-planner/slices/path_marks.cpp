#include "apps/spinaltap-planner/slices/path_marks.h"

#include <QCoreApplication>
#include <QFontMetricsF>
#include <QPainter>
#include <cmath>
#include <optional>

#include "apps/spinaltap-planner/colours.h"
#include "apps/spinaltap-planner/slices/haloed.h"
#include "core/tool/path_curve.h"

namespace spinaltap {
namespace {

constexpr double kOnSliceMm = 0.02;       ///< so near an axis lies in the slice, and section and projection are one
constexpr double kHandleOnSliceMm = 0.5;  ///< farther ends are drawn fainter
constexpr double kFaint = 0.55;

QColor with_alpha(QRgb colour, double alpha) {
  QColor faded(colour);
  faded.setAlphaF(static_cast<float>(alpha));
  return faded;
}

bool holds_axis(const PaneScene& scene, const Vec3& a_mm, const Vec3& b_mm) {
  return std::max(std::abs(scene.behind_mm(a_mm)), std::abs(scene.behind_mm(b_mm))) < kOnSliceMm;
}

void paint_tool(QPainter& painter, const PaneScene& scene, const DrillBit& bit, const Pose& pose, QRgb colour,
                double strength, LabelPlacer& labels) {
  if (!holds_axis(scene, pose.tip_mm, pose.tip_mm - bit.length_mm * pose.axis)) {
    QPen dashed(with_alpha(colour, 0.6 * strength), 1.0, Qt::CustomDashLine);
    dashed.setDashPattern({5.0, 4.0});
    painter.setPen(dashed);
    painter.setBrush(Qt::NoBrush);
    for (const PixelPolygon& part : bit_projection(scene.frame, bit, pose)) painter.drawPolygon(scene.drawn(part));
  }
  for (const PixelPolygon& part : bit_section(scene.frame, bit, pose)) {
    labels.avoid_shape(scene.in_logical(part));
    draw_haloed_polygon(painter, scene.drawn(part), QPen(with_alpha(colour, strength), 1.5),
                        with_alpha(colour, 0.22 * strength));
  }
}

void paint_axis(QPainter& painter, const PaneScene& scene, const DrillPath& path, double strength) {
  QPen pen(with_alpha(kTextRgb, strength), 1.0, Qt::CustomDashLine);
  pen.setDashPattern({9.0, 3.0, 2.0, 3.0});
  if (!path.is_curved()) return draw_haloed_line(painter, scene.drawn(path.entry_mm), scene.drawn(path.target_mm), pen);
  const std::vector<Vec3> places_mm = PathCurve(path).places_mm(0.5);
  std::vector<QLineF> lines;
  for (std::size_t n = 1; n < places_mm.size(); ++n) {
    lines.emplace_back(scene.drawn(places_mm[n - 1]), scene.drawn(places_mm[n]));
  }
  pen.setStyle(Qt::SolidLine);  // dashes would begin anew on each short line
  draw_haloed_lines(painter, lines, pen);
}

/// Round for the entry, square for the target; hollow, so that the bone below is seen.
void paint_handle(QPainter& painter, const PaneScene& scene, int index, PathEnd end) {
  const DrillPath& path = scene.paths[static_cast<std::size_t>(index)];
  const bool is_entry = end == PathEnd::entry;
  const Vec3& p_mm = is_entry ? path.entry_mm : path.target_mm;
  const bool is_hot = scene.hot == PathHit{index, end};
  const bool is_near = std::abs(scene.behind_mm(p_mm)) < kHandleOnSliceMm;
  const bool is_chosen = index == scene.chosen;
  const double radius = (is_chosen ? 6.0 : 4.5) * (is_hot ? 1.5 : 1.0) - (is_entry ? 0.0 : 0.7);
  const double strength = (is_chosen || is_hot ? 1.0 : kFaint) * (is_near || is_hot ? 1.0 : kFaint);
  const QColor colour = with_alpha(is_entry ? kEntryRgb : kTargetRgb, strength);
  const QPointF at = scene.drawn(p_mm);
  const QRectF box(at.x() - radius, at.y() - radius, 2.0 * radius, 2.0 * radius);
  const auto outline = [&](const QPen& pen, const QBrush& fill) {
    painter.setPen(pen);
    painter.setBrush(fill);
    is_entry ? painter.drawEllipse(box) : painter.drawRect(box);
  };
  outline(QPen(QColor(0, 0, 0, static_cast<int>(150 * strength)), 4.0), Qt::NoBrush);
  outline(QPen(colour, 2.0), is_hot ? QBrush(with_alpha(is_entry ? kEntryRgb : kTargetRgb, 0.3)) : QBrush());
  painter.setBrush(Qt::NoBrush);
}

QString place_words(double behind_mm) {
  const auto tr = [](const char* words) { return QCoreApplication::translate("spinaltap::SliceView", words); };
  if (std::abs(behind_mm) < 0.05) return tr("on this slice");
  const QString words = behind_mm > 0.0 ? tr("%1 mm behind this slice") : tr("%1 mm before this slice");
  return words.arg(std::abs(behind_mm), 0, 'f', 1);
}

/// The path's name beside the end that the pane shows; of an end under the pointer also where it lies.
void paint_name(QPainter& painter, const PaneScene& scene, int index, LabelPlacer& labels) {
  const DrillPath& path = scene.paths[static_cast<std::size_t>(index)];
  const QRectF pane(QPointF(0.0, 0.0), scene.size());
  const auto tr = [](const char* words) { return QCoreApplication::translate("spinaltap::SliceView", words); };
  QString text = QString::fromStdString(path.name);
  QPointF at = scene.drawn(path.entry_mm);
  if (scene.hot && scene.hot->path == index && scene.hot->end) {
    const bool is_entry = *scene.hot->end == PathEnd::entry;
    const Vec3& p_mm = is_entry ? path.entry_mm : path.target_mm;
    at = scene.drawn(p_mm);
    text += (is_entry ? tr(": entry, ") : tr(": target, ")) + place_words(scene.behind_mm(p_mm));
  } else if (!pane.contains(at)) {
    at = scene.drawn(path.target_mm);
  }
  if (!pane.contains(at) || text.isEmpty()) return;
  const bool is_chosen = index == scene.chosen;
  set_text_size(painter, 9.5, is_chosen);
  const QFontMetricsF metrics(painter.font());
  const auto place = labels.place({at.x(), at.y()}, {metrics.horizontalAdvance(text) + 4.0, metrics.height()});
  draw_haloed_text(painter, {place.center().x(), place.center().y()}, TextAnchor::middle, text,
                   with_alpha(path_colour(static_cast<std::size_t>(index)).rgb(), is_chosen ? 1.0 : 0.85));
}

void paint_body(QPainter& painter, const PaneScene& scene, int index, LabelPlacer& labels) {
  const DrillPath& path = scene.paths[static_cast<std::size_t>(index)];
  const bool is_chosen = index == scene.chosen;
  const double strength = is_chosen ? 1.0 : kFaint;
  const PathCurve curve(path);
  const Pose at_target{path.target_mm, curve.direction_at(curve.length_mm())};
  if (path.screw) paint_tool(painter, scene, path.screw->outline(), at_target, kScrewRgb, strength, labels);
  if (const std::optional<BodyBehind> head = head_of(path)) {
    paint_tool(painter, scene, head->outline, head->pose, kScrewRgb, strength, labels);
  }
  if (!(is_chosen && scene.bit)) {
    paint_tool(painter, scene, path.bit, at_target, path_colour(static_cast<std::size_t>(index)).rgb(), strength,
               labels);
  }
  paint_axis(painter, scene, path, is_chosen ? 0.95 : kFaint);
}

void paint_walls(QPainter& painter, const PaneScene& scene) {
  std::vector<QLineF> lines;
  for (const auto& [from, to] : scene.walls.section(scene.frame)) {
    const Eigen::Vector2d a = scene.in_logical(from), b = scene.in_logical(to);
    lines.emplace_back(a.x(), a.y(), b.x(), b.y());
  }
  draw_haloed_lines(painter, lines, QPen(QColor(kHoleRgb), 1.5));
}

void avoid_handle(const PaneScene& scene, const Vec3& p_mm, LabelPlacer& labels) {
  constexpr double kAroundPx = 10.0;
  const QPointF at = scene.drawn(p_mm);
  labels.avoid({Eigen::Vector2d(at.x() - kAroundPx, at.y() - kAroundPx),
                Eigen::Vector2d(at.x() + kAroundPx, at.y() + kAroundPx)});
}

}  // namespace

void paint_paths(QPainter& painter, const PaneScene& scene, LabelPlacer& labels) {
  std::vector<int> order;
  for (int i = 0; i < static_cast<int>(scene.paths.size()); ++i) {
    if (i != scene.chosen) order.push_back(i);
  }
  if (scene.chosen >= 0) order.push_back(scene.chosen);
  for (const int index : order) paint_body(painter, scene, index, labels);
  if (scene.bit) paint_tool(painter, scene, scene.bit->first, scene.bit->second, kDrillRgb, 1.0, labels);
  paint_walls(painter, scene);
  for (const int index : order) {
    const DrillPath& path = scene.paths[static_cast<std::size_t>(index)];
    for (const Vec3& p_mm : {path.entry_mm, path.target_mm}) avoid_handle(scene, p_mm, labels);
    paint_handle(painter, scene, index, PathEnd::target);
    paint_handle(painter, scene, index, PathEnd::entry);
  }
  // The chosen one's name gets the best place.
  for (auto index = order.rbegin(); index != order.rend(); ++index) paint_name(painter, scene, *index, labels);
}

}  // namespace spinaltap
