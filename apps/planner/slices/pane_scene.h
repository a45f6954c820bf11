#pragma once

#include <QPointF>
#include <QPolygonF>
#include <QSizeF>
#include <optional>
#include <utility>
#include <vector>

#include "apps/planner/slices/path_hits.h"
#include "apps/report/bit_outline.h"

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

  QSizeF size() const { return {frame.width / ratio, frame.height / ratio}; }
  QPointF drawn(const Eigen::Vector2d& pixel) const { return {(pixel.x() + 0.5) / ratio, (pixel.y() + 0.5) / ratio}; }
  QPointF drawn(const Vec3& p_mm) const { return drawn(Eigen::Vector2d(frame.to_pixel(p_mm).head<2>())); }
  QPolygonF drawn(const PixelPolygon& polygon) const {
    QPolygonF points;
    for (const Eigen::Vector2d& p : polygon) points << drawn(p);
    return points;
  }
  /// How far a place lies behind the slice (mm; negative: before it).
  double behind_mm(const Vec3& p_mm) const { return frame.to_pixel(p_mm).z() * frame.pixel_mm; }
};

}  // namespace spinaltap
