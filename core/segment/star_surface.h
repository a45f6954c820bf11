#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/base/geometry.h"

namespace spinaltap {

/// A closed surface seen whole from one point: for each of many directions, spread evenly over the sphere, a radius.
class StarSurface {
 public:
  /// All radii are 0. Throws Error on fewer than 100 directions.
  StarSurface(const Vec3& centre_mm, int direction_count);

  const Vec3& centre_mm() const { return centre_mm_; }
  const std::vector<Vec3>& directions() const { return directions_; }
  /// Indices of the directions next to each direction; the relation is symmetric.
  const std::vector<std::vector<int>>& neighbours() const { return neighbours_; }
  std::vector<double>& radii_mm() { return radii_mm_; }
  const std::vector<double>& radii_mm() const { return radii_mm_; }

  /// The radius (mm) in any direction (unit), between those of the directions around it.
  double radius_towards_mm(const Vec3& direction) const;
  /// Depth below the surface along the ray from the centre, mm; negative outside.
  double depth_mm(const Vec3& p_patient) const;
  double volume_mm3() const;
  double largest_radius_mm() const;

 private:
  Vec3 centre_mm_;
  std::vector<Vec3> directions_;
  std::vector<std::vector<int>> neighbours_;
  std::vector<double> radii_mm_;
  double spacing_rad_;

  // The cube around the unit sphere in cells: the directions that may weigh within each, in order.
  std::size_t cell_of(const Vec3& direction) const;
  int cells_a_side_;
  std::vector<std::uint32_t> cell_begin_;
  std::vector<int> in_cells_;
};

/// What choose_radii() minimises: the sum of cost(direction, step) over the directions, plus `stiffness` for each step
/// that two neighbouring radii differ by, up to `max_difference` steps.
struct StarCost {
  std::function<double(int direction, int step)> cost;
  int step_count = 0;
  double stiffness = 0.1;
  int max_difference = 16;
};

/// The step chosen for each direction of a surface: min-sum belief propagation (Felzenszwalb & Huttenlocher 2006) over
/// the neighbours, all messages of a round sent at once, so that the result does not depend on the number of threads.
std::vector<int> choose_steps(const StarSurface& surface, const StarCost& cost, int rounds = 40);

}  // namespace spinaltap
