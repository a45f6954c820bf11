#include "core/phantom/surface_seeds.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cmath>

#include "core/base/error.h"

namespace spinaltap {
namespace {

/// Centres of the cubes that the surface may cross: where the value, which changes by at most 1 mm per mm, can reach 0.
std::vector<Vec3> crossed(const Solid& solid, const std::vector<Vec3>& centres, double side_mm) {
  std::vector<double> values(centres.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, centres.size(), 256), [&](const auto& range) {
    solid.evaluate(std::span(centres).subspan(range.begin(), range.size()),
                   std::span(values).subspan(range.begin(), range.size()), {});
  });
  const double half_diagonal = 0.5 * std::sqrt(3.0) * side_mm;
  std::vector<Vec3> kept;
  for (std::size_t n = 0; n < centres.size(); ++n) {
    if (std::fabs(values[n]) <= half_diagonal) kept.push_back(centres[n]);
  }
  return kept;
}

}  // namespace

std::vector<Vec3> surface_seeds(const Solid& solid, double spacing_mm) {
  if (!(spacing_mm > 0.0)) fail("surface seeds: the spacing must be above 0, found ", spacing_mm, " mm");
  const Box3 bounds = solid.bounds_mm();
  double side = bounds.sizes().maxCoeff();
  if (!(side > 0.0) || !std::isfinite(side)) fail("surface seeds: the solid's bounds are empty or endless");
  constexpr double kMaxCubes = 1e9;
  const double finest = side / spacing_mm;
  if (!(finest * finest < kMaxCubes))
    fail("surface seeds: ", spacing_mm, " mm is too fine for a solid of ", side, " mm");

  std::vector<Vec3> cubes = crossed(solid, {bounds.center()}, side);
  while (side > spacing_mm) {
    side *= 0.5;
    std::vector<Vec3> halves;
    halves.reserve(8 * cubes.size());
    for (const Vec3& centre : cubes) {
      for (int octant = 0; octant < 8; ++octant) {
        const Vec3 sign((octant & 1) != 0 ? 1.0 : -1.0, (octant & 2) != 0 ? 1.0 : -1.0, (octant & 4) != 0 ? 1.0 : -1.0);
        halves.push_back(centre + 0.5 * side * sign);
      }
    }
    cubes = crossed(solid, halves, side);
  }
  return cubes;
}

}  // namespace spinaltap
