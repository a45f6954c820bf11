#include "core/rbf/detail/first_centres.h"

#include <algorithm>

#include "core/rbf/detail/coarse_to_fine.h"
#include "core/rbf/detail/polynomial.h"

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

}  // namespace spinaltap::detail
