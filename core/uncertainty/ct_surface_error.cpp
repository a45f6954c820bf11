#include "core/uncertainty/ct_surface_error.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/error.h"
#include "core/base/statistics.h"

namespace spinaltap {
namespace {

/// Of a wall that stands across an axis along which the CT has this resolution. A straight edge in a row of partial
/// volumes, found at half its height between them: off by (p - 1/2)(1 - p) / p of a voxel, p being the share of bone in
/// the voxel that it cuts; root mean square over all p.
double sampling_mm(double resolution_mm) {
  constexpr double kPartialVolume = 0.0624;
  return kPartialVolume * resolution_mm;
}

/// And by the wall's bend within what the CT averages over: between a rim that is averaged away, which grows as the
/// voxel, and an arc's height over its chord from slice to slice, which grows as its square. Measured on a vertebra
/// that was cut out of CTs of a phantom in slices of 0.5 to 5 mm.
double rounding_mm(double resolution_mm) {
  constexpr double kFineMm = 0.45, kFactor = 0.2, kPower = 1.2;
  return kFactor * std::pow(std::max(0.0, resolution_mm - kFineMm), kPower);
}

/// The share of that for a wall that runs along the axis: it bends less along it than the rims across it do.
constexpr double kAlong = 0.55;

double sampling_squared(const Vec3& normal_index, const Vec3& resolution_mm) {
  double sum = 0.0;
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    sum += std::pow(normal_index[axis] * sampling_mm(resolution_mm[axis]), 2);
  return sum;
}

double rounding_squared(const Vec3& normal_index, const Vec3& resolution_mm) {
  double sum = 0.0;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const double across = normal_index[axis] * normal_index[axis];
    sum += (across + kAlong * kAlong * (1.0 - across)) * std::pow(rounding_mm(resolution_mm[axis]), 2);
  }
  return sum;
}

}  // namespace

Vec3 CtSampling::resolution_mm() const {
  // Where slices overlap, the edge's model undoes some of their blur, the less of it the more of it lies beyond the
  // profile that it sees. Measured as above, in slices of 3 and 5 mm every 1 to 2.5 mm: a bound, not a mean.
  constexpr double kLostPerMm = 0.27;
  Vec3 resolution = voxel_mm;
  const double overlap_mm = std::max(0.0, slice_thickness_mm - voxel_mm.z());
  resolution.z() += kLostPerMm * overlap_mm * overlap_mm;
  return resolution;
}

double CtSurfaceError::standard_error_mm() const { return std::hypot(noise_part_mm, sampling_part_mm, curved_part_mm); }

double CtSurfaceError::standard_error_mm(const Vec3& normal) const {
  if (normal.isZero() || sampling.voxel_mm.isZero()) return standard_error_mm();
  const Vec3 normal_index = sampling.directions.transpose() * normal;
  const Vec3 resolution_mm = sampling.resolution_mm();
  return std::sqrt(noise_part_mm * noise_part_mm + sampling_squared(normal_index, resolution_mm) +
                   rounding_squared(normal_index, resolution_mm));
}

Interval CtSurfaceError::band(double clearance_mm, const Vec3& normal, double confidence) const {
  if (!(confidence > 0.0 && confidence < 1.0)) {
    fail("surface error: expected a confidence between 0 and 1, found ", confidence);
  }
  const double half_mm = normal_quantile(0.5 + 0.5 * confidence) * standard_error_mm(normal);
  return {clearance_mm - half_mm, clearance_mm + half_mm};
}

CtSurfaceError ct_surface_error(double noise_hu, const CtSampling& sampling,
                                std::span<const double> edge_slopes_hu_per_mm, std::span<const Vec3> normals) {
  if (!(noise_hu >= 0.0) || !std::isfinite(noise_hu)) {
    fail("surface error: expected noise of 0 HU or more, found ", noise_hu, " HU");
  }
  if (!(sampling.voxel_mm.minCoeff() > 0.0) || !sampling.voxel_mm.allFinite()) {
    fail("surface error: expected voxels above 0 mm, found ", sampling.voxel_mm.transpose());
  }
  if (!(sampling.slice_thickness_mm >= 0.0) || !std::isfinite(sampling.slice_thickness_mm)) {
    fail("surface error: expected slices of 0 mm or more, found ", sampling.slice_thickness_mm, " mm");
  }
  std::vector<double> slopes(edge_slopes_hu_per_mm.begin(), edge_slopes_hu_per_mm.end());
  if (slopes.empty()) fail("surface error: expected slopes of CT numbers at the surface, found none");
  if (normals.empty()) fail("surface error: expected normals of the surface, found none");
  std::sort(slopes.begin(), slopes.end());
  CtSurfaceError error;
  error.noise_hu = noise_hu;
  error.sampling = sampling;
  error.edge_hu_per_mm = quantile(slopes, 0.5);
  if (!(error.edge_hu_per_mm > 0.0)) {
    fail("surface error: expected CT numbers that fall at the surface, found a slope of ", error.edge_hu_per_mm,
         " HU/mm");
  }
  // Scanners blur their noise as they blur the image: neighbours err together, and interpolation takes nothing off. The
  // noise is measured a tenth too small where tissue is even, and half of the surface is less steep than the median.
  constexpr double kMoreThanMeasured = 1.2;
  error.noise_part_mm = kMoreThanMeasured * noise_hu / error.edge_hu_per_mm;
  const Vec3 resolution_mm = sampling.resolution_mm();
  double sampled = 0.0, rounded = 0.0;
  for (const Vec3& normal : normals) {
    const Vec3 normal_index = sampling.directions.transpose() * normal;
    sampled += sampling_squared(normal_index, resolution_mm);
    rounded += rounding_squared(normal_index, resolution_mm);
  }
  error.sampling_part_mm = std::sqrt(sampled / static_cast<double>(normals.size()));
  error.curved_part_mm = std::sqrt(rounded / static_cast<double>(normals.size()));
  return error;
}

}  // namespace spinaltap
