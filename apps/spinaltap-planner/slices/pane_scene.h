#pragma once

#include <QPointF>
#include <QPolygonF>
#include <QSizeF>
#include <optional>
#include <utility>
#include <vector>

#include "apps/report/bit_outline.h"
#include "apps/spinaltap-planner/slices/hole_walls.h"
#include "apps/spinaltap-planner/slices/path_hits.h"

namespace spinaltap {

/// What is drawn over a slice, and where. Points for the painter are in logical pixels from the pane's corner, in which
/// the middle of device pixel (0, 0) is at (0.5, 0.5) / ratio.
struct PaneScene {
  SliceFrame frame;
  double ratio = 1.0;  ///< device pixels per logical pixel
  Vec3 crosshair_mm = Vec3::Zero();
  const std::vector<DrillPath>& paths;
  int chosen = -1;
  std::optional<PathHit> hot;                    ///< under the pointer or in the hand
  std::optional<std::pair<DrillBit, Pose>> bit;  ///< that drills
  const HoleWalls& walls;

  QSizeF size() const { return {frame.width / ratio, frame.height / ratio}; }
  QPointF drawn(const Vec3& p_mm) const {
    const Eigen::Vector2d p = in_logical(frame.to_pixel(p_mm).head<2>());
    return {p.x(), p.y()};
  }
  QPolygonF drawn(const PixelPolygon& polygon) const {
    QPolygonF points;
    for (const Eigen::Vector2d& p : in_logical(polygon)) points << QPointF(p.x(), p.y());
    return points;
  }
  /// Device pixels as places for the painter.
  Eigen::Vector2d in_logical(const Eigen::Vector2d& pixel) const { return (pixel + Eigen::Vector2d(0.5, 0.5)) / ratio; }
  PixelPolygon in_logical(PixelPolygon polygon) const {
    for (Eigen::Vector2d& p : polygon) p = in_logical(p);
    return polygon;
  }
  /// How far a place lies behind the slice (mm; negative: before it).
  double behind_mm(const Vec3& p_mm) const { return frame.to_pixel(p_mm).z() * frame.pixel_mm; }
};

}  // namespace spinaltap
