#pragma once

#include <span>

#include "core/base/geometry.h"
#include "core/base/statistics.h"

namespace spinaltap {

/// How far a surface that was found in a CT lies from the true one, by the CT's voxels and noise.
/// docs/placement-errors.md derives it and says what it leaves out.
struct CtSurfaceError {
  double noise_hu = 0.0;          ///< standard deviation of a voxel
  Vec3 voxel_mm = Vec3::Zero();   ///< steps of the CT's grid
  double edge_hu_per_mm = 0.0;    ///< slope of the CT numbers at the surface: median
  double noise_part_mm = 0.0;     ///< standard error by the noise, over the slope
  double sampling_part_mm = 0.0;  ///< and by partial volume in the voxels
  double curved_part_mm = 0.0;    ///< and by how voxels of over 0.6 mm shrink a wall as curved as a pedicle's

  double standard_error_mm() const;
  /// Where a clearance (mm) lies, the surface being known no better. Throws Error on a confidence not between 0 and 1.
  Interval band(double clearance_mm, double confidence = 0.95) const;
};

/// `edge_slopes_hu_per_mm`: slopes of the CT numbers at many places of the surface. Throws Error on noise below 0, on
/// voxels not above 0, without slopes, and where half of them are not above 0.
CtSurfaceError ct_surface_error(double noise_hu, const Vec3& voxel_mm, std::span<const double> edge_slopes_hu_per_mm);

}  // namespace spinaltap
