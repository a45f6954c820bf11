#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/base/geometry.h"
#include "core/base/triangle_mesh.h"

namespace spinaltap::test {

/// Measures of a mesh by its triangles alone.
class MeshRays {
 public:
  explicit MeshRays(const TriangleMesh& mesh) {
    for (const auto& t : mesh.triangles) {
      corners_.push_back({mesh.vertices_mm[t[0]].cast<double>(), mesh.vertices_mm[t[1]].cast<double>(),
                          mesh.vertices_mm[t[2]].cast<double>()});
    }
  }

  /// Ways from `p_mm` to the triangles that lie along a unit direction, in no order.
  std::vector<double> ways_mm(const Vec3& p_mm, const Vec3& direction) const {
    std::vector<double> ways;
    for (const auto& [a, b, c] : corners_) {
      Mat3 sides;
      sides << b - a, c - a, -direction;
      if (std::abs(sides.determinant()) < 1e-12) continue;
      const Vec3 at = sides.inverse() * (p_mm - a);
      if (at.x() >= 0.0 && at.y() >= 0.0 && at.x() + at.y() <= 1.0 && at.z() > 0.0) ways.push_back(at.z());
    }
    return ways;
  }

  /// To the first of them; infinite where there is none.
  double to_surface_mm(const Vec3& p_mm, const Vec3& direction) const {
    double nearest_mm = std::numeric_limits<double>::infinity();
    for (const double way_mm : ways_mm(p_mm, direction)) nearest_mm = std::min(nearest_mm, way_mm);
    return nearest_mm;
  }

  /// Of a closed mesh.
  bool is_inside(const Vec3& p_mm) const { return ways_mm(p_mm, Vec3(0.6, 0.48, 0.64)).size() % 2 == 1; }

  /// From surface to surface through a place, along +-direction.
  double span_mm(const Vec3& p_mm, const Vec3& direction) const {
    return to_surface_mm(p_mm, direction) + to_surface_mm(p_mm, -direction);
  }

 private:
  std::vector<std::array<Vec3, 3>> corners_;
};

/// The plane section of a mesh around a place in it: what is seen of its contour from there.
class MeshSection {
 public:
  MeshSection(const TriangleMesh& mesh, const Vec3& p_mm, const Vec3& normal) {
    constexpr std::size_t kRays = 180;
    const Vec3 u = any_perpendicular(normal), v = normal.cross(u);
    radii_mm_.assign(kRays, std::numeric_limits<double>::infinity());
    directions_.resize(kRays);
    for (std::size_t n = 0; n < kRays; ++n) {
      const double angle = 2.0 * std::numbers::pi * static_cast<double>(n) / kRays;
      directions_[n] = std::cos(angle) * u + std::sin(angle) * v;
    }
    for (const auto& t : mesh.triangles) {
      std::array<Vec3, 3> corners;
      std::array<double, 3> heights_mm{};
      for (std::size_t n = 0; n < 3; ++n) {
        corners[n] = mesh.vertices_mm[t[n]].cast<double>() - p_mm;
        heights_mm[n] = normal.dot(corners[n]);
      }
      std::vector<Vec3> ends;
      for (std::size_t n = 0; n < 3; ++n) {
        const std::size_t next = (n + 1) % 3;
        if ((heights_mm[n] < 0.0) == (heights_mm[next] < 0.0)) continue;
        const double share = heights_mm[n] / (heights_mm[n] - heights_mm[next]);
        ends.push_back(corners[n] + share * (corners[next] - corners[n]));
      }
      if (ends.size() == 2) meet(normal, ends[0], ends[1]);
    }
  }

  double area_mm2() const {
    double sum = 0.0;
    for (const double radius_mm : radii_mm_) sum += 0.5 * radius_mm * radius_mm;
    return sum * 2.0 * std::numbers::pi / static_cast<double>(radii_mm_.size());
  }

  double extent_mm(const Vec3& axis) const {
    double low_mm = 0.0, high_mm = 0.0;
    for (std::size_t n = 0; n < radii_mm_.size(); ++n) {
      const double along_mm = radii_mm_[n] * directions_[n].dot(axis);
      low_mm = std::min(low_mm, along_mm);
      high_mm = std::max(high_mm, along_mm);
    }
    return high_mm - low_mm;
  }

 private:
  /// Shortens the rays that the segment a b crosses.
  void meet(const Vec3& normal, const Vec3& a, const Vec3& b) {
    for (std::size_t n = 0; n < directions_.size(); ++n) {
      const Vec3 beside = normal.cross(directions_[n]);
      const double side_a = beside.dot(a), side_b = beside.dot(b);
      if ((side_a < 0.0) == (side_b < 0.0)) continue;
      const double way_mm = directions_[n].dot(a + side_a / (side_a - side_b) * (b - a));
      if (way_mm > 0.0) radii_mm_[n] = std::min(radii_mm_[n], way_mm);
    }
  }

  std::vector<Vec3> directions_;
  std::vector<double> radii_mm_;
};

}  // namespace spinaltap::test
