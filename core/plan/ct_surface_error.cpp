#include "core/plan/ct_surface_error.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/error.h"

namespace spinaltap {

double CtSurfaceError::standard_error_mm() const { return std::hypot(noise_part_mm, sampling_part_mm, curved_part_mm); }

Interval CtSurfaceError::band(double clearance_mm, double confidence) const {
  if (!(confidence > 0.0 && confidence < 1.0)) {
    fail("surface error: expected a confidence between 0 and 1, found ", confidence);
  }
  const double half_mm = normal_quantile(0.5 + 0.5 * confidence) * standard_error_mm();
  return {clearance_mm - half_mm, clearance_mm + half_mm};
}

CtSurfaceError ct_surface_error(double noise_hu, const Vec3& voxel_mm, std::span<const double> edge_slopes_hu_per_mm) {
  if (!(noise_hu >= 0.0) || !std::isfinite(noise_hu)) {
    fail("surface error: expected noise of 0 HU or more, found ", noise_hu, " HU");
  }
  if (!(voxel_mm.minCoeff() > 0.0) || !voxel_mm.allFinite()) {
    fail("surface error: expected voxels above 0 mm, found ", voxel_mm.transpose());
  }
  std::vector<double> slopes(edge_slopes_hu_per_mm.begin(), edge_slopes_hu_per_mm.end());
  if (slopes.empty()) fail("surface error: expected slopes of CT numbers at the surface, found none");
  std::sort(slopes.begin(), slopes.end());
  CtSurfaceError error;
  error.noise_hu = noise_hu;
  error.voxel_mm = voxel_mm;
  error.edge_hu_per_mm = quantile(slopes, 0.5);
  if (!(error.edge_hu_per_mm > 0.0)) {
    fail("surface error: expected CT numbers that fall at the surface, found a slope of ", error.edge_hu_per_mm,
         " HU/mm");
  }
  // Scanners blur their noise as they blur the image: neighbours err together, and interpolation takes nothing off.
  error.noise_part_mm = noise_hu / error.edge_hu_per_mm;
  // A straight edge in a row of partial volumes, found at half its height between them: off by (p - 1/2)(1 - p) / p of
  // a voxel, p being the share of bone in the voxel that it cuts; root mean square over all p.
  constexpr double kPartialVolume = 0.0624;
  error.sampling_part_mm = kPartialVolume * std::sqrt(voxel_mm.squaredNorm() / 3.0);
  // Measured on eggs as slender as pedicles in voxels of 0.4 to 5 mm.
  constexpr double kFineMm = 0.6, kPerMm = 0.12;
  error.curved_part_mm = kPerMm * (voxel_mm.array() - kFineMm).max(0.0).matrix().norm();
  return error;
}

}  // namespace spinaltap
