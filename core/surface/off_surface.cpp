#include "core/surface/off_surface.h"

#include <cmath>

namespace spinaltap {

double off_surface_length_mm(const PointGrid& grid, const Vec3& p_mm, const Vec3& direction, double wanted_mm) {
  constexpr double kOwnPatch = 0.98;  // neighbours on the same patch are nearer by curvature, but only a little
  constexpr double kShortestMm = 0.05;
  for (double length_mm = wanted_mm; length_mm > kShortestMm; length_mm *= 0.7) {
    const PointGrid::Nearest nearest = grid.nearest_within(p_mm + length_mm * direction, kOwnPatch * length_mm);
    if (!std::isfinite(nearest.distance_mm)) return length_mm;
  }
  return 0.0;
}

}  // namespace spinaltap
