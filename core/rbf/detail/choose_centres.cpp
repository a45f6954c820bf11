#include "core/rbf/detail/choose_centres.h"

#include <algorithm>
#include <cmath>

#include "core/rbf/detail/coarse_to_fine.h"
#include "core/rbf/detail/polynomial.h"
#include "core/rbf/detail/sparse_grid.h"

namespace spinaltap::detail {

std::vector<std::uint32_t> first_centres(RadialKernel kernel, std::span<const Vec3> points_mm) {
  constexpr double kShare = 0.01;
  constexpr std::size_t kFewest = 64;
  const std::size_t count = points_mm.size();
  std::vector<std::uint32_t> order = coarse_to_fine(points_mm, determining_points(kernel, points_mm), 0).order;
  order.resize(
      std::clamp(static_cast<std::size_t>(kShare * static_cast<double>(count)), std::min(kFewest, count), count));
  return order;
}

std::vector<std::uint32_t> spread_worst(std::span<const Vec3> points_mm, const std::vector<std::uint32_t>& out,
                                        std::size_t centres) {
  constexpr double kGrowth = 0.5;
  constexpr std::size_t kFewest = 50;
  constexpr double kGap = 0.7;  // of the centres' mean spacing, were they spread on the faces of their box
  const Box3 bounds = bounds_of(points_mm);
  const Vec3 size_mm = bounds.sizes();
  const double area_mm2 = 2.0 * (size_mm.x() * size_mm.y() + size_mm.y() * size_mm.z() + size_mm.z() * size_mm.x());
  const double gap_mm = kGap * std::sqrt(area_mm2 / static_cast<double>(centres));
  const auto room = std::max(kFewest, static_cast<std::size_t>(kGrowth * static_cast<double>(centres)));

  SparseGrid near(points_mm, 2.0 * gap_mm, out.size());
  std::vector<std::uint32_t> chosen;
  for (const std::uint32_t i : out) {
    if (chosen.size() == room) break;
    if (near.visit_within(points_mm[i], gap_mm, [](std::uint32_t, double) { return true; })) continue;
    near.add(i);
    chosen.push_back(i);
  }
  return chosen;
}

}  // namespace spinaltap::detail
