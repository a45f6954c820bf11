#include "apps/report/bit_outline.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/base/error.h"
#include "core/tool/bit_profile.h"
#include "core/tool/plate.h"

namespace spinaltap {
namespace {

constexpr int kAround = 96;  ///< points around the bit: 1 - cos(pi / 96) = 0.05% of the radius

/// How far back from the tip a piece's outline is followed: a ball's at 24 places, a straight one at its ends.
std::vector<double> stations_mm(const ProfilePiece& piece) {
  const int steps = piece.ball_radius_mm > 0.0 ? 24 : 1;
  std::vector<double> stations;
  for (int n = 0; n <= steps; ++n) {
    // Even angles around a ball.
    const double share = steps == 1 ? n : 0.5 - 0.5 * std::cos(std::numbers::pi * n / steps);
    stations.push_back(piece.begin_mm + share * (piece.end_mm - piece.begin_mm));
  }
  return stations;
}

/// Circles around the axis, or a plate's edges, from the tip on, in pixels, depth third.
using Rims = std::vector<std::vector<Vec3>>;

Rims rims_of_plate(const SliceFrame& frame, const DrillBit& plate, const Pose& pose) {
  const std::optional<Pose> sound = valid_pose(pose, plate);
  if (!sound) fail("a plate's outline: expected a sound pose");
  const PlateBox box(plate);
  const Mat3 to_patient = plate_rows(*sound).transpose();
  const Vec3& high_mm = box.high_mm();
  Rims rims;
  for (const double back_mm : {0.0, box.length_mm()}) {
    std::vector<Vec3>& rim = rims.emplace_back();
    for (const auto& [x, y] :
         {std::pair(-1.0, -1.0), std::pair(1.0, -1.0), std::pair(1.0, 1.0), std::pair(-1.0, 1.0)}) {
      rim.push_back(frame.to_pixel(sound->tip_mm + to_patient * Vec3(x * high_mm.x(), y * high_mm.y(), back_mm)));
    }
  }
  return rims;
}

Rims rims_of(const SliceFrame& frame, const ToolPart& part, const Pose& pose) {
  if (part.plate) return rims_of_plate(frame, *part.plate, pose);
  const Vec3 back = -pose.axis.normalized();
  const Vec3 side = any_perpendicular(back);
  const Vec3 other = back.cross(side);
  Rims rims;
  for (const Eigen::Vector2d& station : part.outline) {
    std::vector<Vec3>& rim = rims.emplace_back();
    for (int i = 0; i < kAround; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kAround;
      const Vec3 out = station.y() * (std::cos(angle) * side + std::sin(angle) * other);
      rim.push_back(frame.to_pixel(pose.tip_mm + station.x() * back + out));
    }
  }
  return rims;
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

std::vector<ToolPart> tool_parts(const DrillBit& bit) {
  if (bit.is_plate()) {
    check_bit(bit);
    return {{.plate = bit}};
  }
  std::vector<ToolPart> parts;
  const BitProfile profile(bit);
  for (const ProfilePiece& piece : profile.pieces()) {
    if (parts.empty() || !profile.is_cone_and_cylinder()) parts.emplace_back();
    for (const double back_mm : stations_mm(piece)) {
      parts.back().outline.emplace_back(back_mm, std::sqrt(std::max(0.0, piece.radius_squared_mm2(back_mm))));
    }
  }
  return parts;
}

PixelPolygon part_projection(const SliceFrame& frame, const ToolPart& part, const Pose& pose) {
  // A convex part's shadow is the hull of its rims' shadows.
  std::vector<Eigen::Vector2d> points;
  for (const std::vector<Vec3>& rim : rims_of(frame, part, pose)) {
    for (const Vec3& p : rim) points.push_back(p.head<2>());
  }
  return convex_hull(std::move(points));
}

PixelPolygon part_section(const SliceFrame& frame, const ToolPart& part, const Pose& pose) {
  const Rims rims = rims_of(frame, part, pose);
  std::vector<Eigen::Vector2d> points;
  for (std::size_t n = 0; n < rims.size(); ++n) {
    for (std::size_t i = 0; i < rims[n].size(); ++i) {
      add_crossing(rims[n][i], rims[n][(i + 1) % rims[n].size()], points);
      if (n > 0) add_crossing(rims[n - 1][i], rims[n][i], points);
    }
  }
  return convex_hull(std::move(points));
}

std::vector<PixelPolygon> bit_projection(const SliceFrame& frame, const DrillBit& bit, const Pose& pose) {
  std::vector<PixelPolygon> polygons;
  for (const ToolPart& part : tool_parts(bit)) polygons.push_back(part_projection(frame, part, pose));
  return polygons;
}

std::vector<PixelPolygon> bit_section(const SliceFrame& frame, const DrillBit& bit, const Pose& pose) {
  std::vector<PixelPolygon> polygons;
  for (const ToolPart& part : tool_parts(bit)) {
    PixelPolygon polygon = part_section(frame, part, pose);
    if (!polygon.empty()) polygons.push_back(std::move(polygon));
  }
  return polygons;
}

}  // namespace spinaltap
