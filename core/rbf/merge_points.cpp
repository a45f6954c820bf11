#include "core/rbf/merge_points.h"

#include <algorithm>

#include "core/rbf/detail/sparse_grid.h"

namespace spinaltap::detail {

std::vector<std::uint32_t> merge_points(std::span<const Vec3> points_mm, double merge_mm) {
  // Cells far smaller than the whole would count beyond integers; what is nearer than that is the same place.
  constexpr double kFinest = 1e-12;
  const Box3 bounds = bounds_of(points_mm);
  const double largest_mm = std::max(bounds.min().cwiseAbs().maxCoeff(), bounds.max().cwiseAbs().maxCoeff());
  const double reach_mm = std::max(merge_mm, kFinest * largest_mm);
  SparseGrid kept(points_mm, 2.0 * std::max(reach_mm, 1e-300), points_mm.size());
  std::vector<std::uint32_t> stands_for(points_mm.size());
  for (std::uint32_t i = 0; i < points_mm.size(); ++i) {
    std::uint32_t first = i;
    kept.visit_within(points_mm[i], reach_mm, [&](std::uint32_t index, double) {
      first = std::min(first, index);
      return false;
    });
    stands_for[i] = first;
    if (first == i) kept.add(i);
  }
  return stands_for;
}

}  // namespace spinaltap::detail
