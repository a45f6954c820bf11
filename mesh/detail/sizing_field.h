#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/base/point_grid.h"
#include "core/base/triangle_mesh.h"

namespace spinaltap::detail {

struct SizingLimits {
  double error_mm = 0.05;  ///< a chord may lie this far from the surface
  double shortest_mm = 0.1;
  double longest_mm = 5.0;
  double slope = 0.4;  ///< the wanted length changes by at most so much a mm
};

/// How long edges may be, everywhere on a surface: what its curvature and the error allow (Dunyach et al. 2013, section
/// 3), changing slowly from place to place.
class SizingField {
 public:
  /// From points on the surface with their (unit) normals, and triangles that join them.
  SizingField(std::vector<Vec3> points_mm, std::span<const Vec3> normals,
              std::span<const std::array<std::uint32_t, 3>> triangles, const SizingLimits& limits);

  /// Wanted edge length near p.
  double at(const Vec3& p_mm) const;
  double at_point(std::size_t point) const { return length_mm_[point]; }
  std::span<const Vec3> points_mm() const { return points_mm_; }

  struct Cap {
    Vec3 place_mm;
    double radius_mm = 0.0;
    double length_mm = 0.0;
  };
  /// Makes the lengths around places no longer than asked for, then evens out.
  void refine(std::span<const Cap> caps);

 private:
  void even_out();

  std::vector<Vec3> points_mm_;
  std::vector<double> length_mm_;
  std::vector<std::uint32_t> first_;  ///< of point i: the first place in neighbours_; one more than points
  std::vector<std::uint32_t> neighbours_;
  double slope_;
  double longest_mm_;
  double reach_mm_ = 0.0;  ///< of most points the nearest other one is nearer
  std::unique_ptr<PointGrid> grid_;
};

}  // namespace spinaltap::detail
