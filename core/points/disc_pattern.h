#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "core/points/point_volume_options.h"

namespace spinaltap {

/// The points of one disc: a centre, then rings k = 1, 2, ... of 6k points at radius k * spacing (the paper's section
/// 6.4), or of as many along hexagons with corners there. Ring k starts at index 1 + 3k(k-1); n rings, the centre
/// counted as the first, make 3n(n-1)+1 points. Point i of ring k lies at, or near, angle 2 pi i / 6k from x.
class DiscPattern {
 public:
  /// n = radius / spacing rings, rounded to the nearest whole number. Throws Error when that is below 1 or above 4,096.
  DiscPattern(double radius_mm, double spacing_mm, DiscSubdivision subdivision = DiscSubdivision::rings);

  double spacing_mm() const { return spacing_mm_; }
  DiscSubdivision subdivision() const { return subdivision_; }
  /// Rings, the centre counted as ring 0.
  int ring_count() const { return ring_count_; }
  std::size_t point_count() const { return points_mm_.size(); }
  /// Index of the first point of ring k.
  static std::size_t ring_start(int ring) {
    const auto k = static_cast<std::size_t>(ring);
    return ring == 0 ? 0 : 1 + 3 * k * (k - 1);
  }
  static std::size_t ring_size(int ring) { return ring == 0 ? 1 : 6 * static_cast<std::size_t>(ring); }
  /// The ring that holds the point.
  static int ring_of(std::size_t index);
  /// Path-local x and y of a point, mm.
  const Eigen::Vector2d& point_mm(std::size_t index) const { return points_mm_[index]; }
  /// How far points of a ring lie, at most, from where even steps around its circle would be, mm.
  double deviation_mm(int ring) const;
  /// Volume (mm³) that a point of the ring stands for: its share of the disc's area, times the disc spacing.
  double point_volume_mm3(int ring) const;

 private:
  /// A hexagon's flats lie 1 - cos 30 degrees nearer than its corners; points between are turned a little as well.
  static constexpr double kHexagonDeviation = 0.135;

  double spacing_mm_;
  DiscSubdivision subdivision_;
  int ring_count_;
  std::vector<Eigen::Vector2d> points_mm_;
};

}  // namespace spinaltap
