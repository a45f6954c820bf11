#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/base/geometry.h"

namespace spinaltap {

/// Finds points near a place: a uniform grid of cells over a fixed set of points.
class PointGrid {
 public:
  /// `points_mm` must outlive the grid. Throws Error when a point is not finite or `cell_mm` not above 0.
  PointGrid(std::span<const Vec3> points_mm, double cell_mm);

  /// Calls visit(index) for every point within `radius_mm` of p, in an order that depends on the points alone.
  template <class Visit>
  void for_each_within(const Vec3& p_mm, double radius_mm, const Visit& visit) const {
    if (!p_mm.allFinite()) return;  // no cell holds it
    const Eigen::Array3i low = cell_of(p_mm - Vec3::Constant(radius_mm));
    const Eigen::Array3i high = cell_of(p_mm + Vec3::Constant(radius_mm));
    const double radius_squared = radius_mm * radius_mm;
    for (int k = low.z(); k <= high.z(); ++k) {
      for (int j = low.y(); j <= high.y(); ++j) {
        for (int i = low.x(); i <= high.x(); ++i) {
          const std::size_t cell = cell_index(i, j, k);
          for (std::uint32_t at = cell_start_[cell]; at < cell_start_[cell + 1]; ++at) {
            const std::uint32_t index = order_[at];
            if ((points_mm_[index] - p_mm).squaredNorm() <= radius_squared) visit(index);
          }
        }
      }
    }
  }

  struct Nearest {
    std::size_t index = std::numeric_limits<std::size_t>::max();
    double distance_mm = std::numeric_limits<double>::infinity();
  };
  /// The point nearest to p within `radius_mm`; of equally near ones the first. Index is max() when there is none.
  Nearest nearest_within(const Vec3& p_mm, double radius_mm) const;

 private:
  Eigen::Array3i cell_of(const Vec3& p_mm) const;
  std::size_t cell_index(int i, int j, int k) const {
    return (static_cast<std::size_t>(k) * static_cast<std::size_t>(cells_.y()) + static_cast<std::size_t>(j)) *
               static_cast<std::size_t>(cells_.x()) +
           static_cast<std::size_t>(i);
  }

  std::span<const Vec3> points_mm_;
  Vec3 low_mm_ = Vec3::Zero();
  double cell_mm_ = 1.0;
  Eigen::Array3i cells_ = Eigen::Array3i::Ones();
  std::vector<std::uint32_t> cell_start_;  ///< of cell c: the first place in order_; one more than there are cells
  std::vector<std::uint32_t> order_;       ///< point indices, cell by cell, ascending within a cell
};

/// Points that keep `spacing_mm` from each other, taken in the order of the input: a Poisson-disc subset. Only points
/// whose normals lie within 60 degrees count as near to each other: both sides of a thin part are kept. `normals` are
/// unit vectors, one a point. Returns indices, ascending.
std::vector<std::size_t> spread_subset(std::span<const Vec3> points_mm, std::span<const Vec3> normals,
                                       double spacing_mm);

}  // namespace spinaltap
