#include "apps/report/bit_outline.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace spinaltap {
namespace {

constexpr int kAround = 96;  ///< points around the bit: 1 - cos(pi / 96) = 0.05% of the radius

/// The bit's surface as lines along it (tip, end of the cone, end of the shaft) in pixels, depth third.
struct Generators {
  Vec3 tip;
  std::vector<Vec3> cone_end;
  std::vector<Vec3> shaft_end;
};

Generators generators(const SliceFrame& frame, const DrillBit& bit, const Pose& pose) {
  const Vec3 back = -pose.axis.normalized();
  const Vec3 side = any_perpendicular(back);
  const Vec3 other = back.cross(side);
  Generators lines;
  lines.tip = frame.to_pixel(pose.tip_mm);
  for (int i = 0; i < kAround; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kAround;
    const Vec3 rim = pose.tip_mm + bit.radius_mm() * (std::cos(angle) * side + std::sin(angle) * other);
    lines.cone_end.push_back(frame.to_pixel(rim + bit.tip_length_mm * back));
    lines.shaft_end.push_back(frame.to_pixel(rim + bit.length_mm * back));
  }
  return lines;
}

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Andrew's monotone chain (1979).
PixelPolygon convex_hull(std::vector<Eigen::Vector2d> points) {
  const auto before = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
  };
  std::sort(points.begin(), points.end(), before);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return {};
  PixelPolygon hull;
  const auto add_chain = [&](auto first, auto last) {
    const std::size_t start = hull.size();
    for (auto p = first; p != last; ++p) {
      while (hull.size() >= start + 2 &&
             cross(hull.back() - hull[hull.size() - 2], *p - hull[hull.size() - 2]) <= 0.0) {
        hull.pop_back();
      }
      hull.push_back(*p);
    }
    hull.pop_back();  // the next chain starts with it
  };
  add_chain(points.begin(), points.end());
  add_chain(points.rbegin(), points.rend());
  return hull.size() < 3 ? PixelPolygon{} : hull;
}

/// Adds the point where the segment meets depth 0, both ends where it lies there.
void add_crossing(const Vec3& a, const Vec3& b, std::vector<Eigen::Vector2d>& points) {
  constexpr double kOnPlane = 1e-9;  // pixels; an axis in the plane is there to rounding only
  const bool a_on = std::abs(a.z()) < kOnPlane;
  const bool b_on = std::abs(b.z()) < kOnPlane;
  if (a_on) points.push_back(a.head<2>());
  if (b_on) points.push_back(b.head<2>());
  if (a_on || b_on || a.z() * b.z() > 0.0) return;
  points.push_back((a + a.z() / (a.z() - b.z()) * (b - a)).head<2>());
}

}  // namespace

PixelPolygon bit_projection(const SliceFrame& frame, const DrillBit& bit, const Pose& pose) {
  // The bit is convex, so its shadow is the hull of its rims' and tip's shadows.
  const Generators lines = generators(frame, bit, pose);
  std::vector<Eigen::Vector2d> points{lines.tip.head<2>()};
  for (const Vec3& p : lines.cone_end) points.push_back(p.head<2>());
  for (const Vec3& p : lines.shaft_end) points.push_back(p.head<2>());
  return convex_hull(std::move(points));
}

PixelPolygon bit_section(const SliceFrame& frame, const DrillBit& bit, const Pose& pose) {
  const Generators lines = generators(frame, bit, pose);
  std::vector<Eigen::Vector2d> points;
  for (std::size_t i = 0; i < lines.cone_end.size(); ++i) {
    const std::size_t next = (i + 1) % lines.cone_end.size();
    add_crossing(lines.tip, lines.cone_end[i], points);
    add_crossing(lines.cone_end[i], lines.shaft_end[i], points);
    add_crossing(lines.cone_end[i], lines.cone_end[next], points);
    add_crossing(lines.shaft_end[i], lines.shaft_end[next], points);
  }
  return convex_hull(std::move(points));
}

}  // namespace spinaltap
