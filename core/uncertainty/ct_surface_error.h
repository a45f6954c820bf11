#pragma once

#include <span>

#include "core/base/geometry.h"

namespace spinaltap {

/// Over what a CT averages: the steps of its grid, and its slices where they are thicker than their step.
struct CtSampling {
  Vec3 voxel_mm = Vec3::Zero();        ///< steps of the grid
  double slice_thickness_mm = 0.0;     ///< 0: not known, taken for the step
  Mat3 directions = Mat3::Identity();  ///< columns: the grid's axes, unit, patient LPS

  /// Along the grid's axes, mm: the step, and across slices that overlap what of their thickness cannot be undone.
  Vec3 resolution_mm() const;
};

/// How far a surface that was found in a CT lies from the true one, by the CT's voxels, slices and noise: more where
/// the wall faces along the coarser axis. docs/placement-errors.md derives it and says what it leaves out.
struct CtSurfaceError {
  double noise_hu = 0.0;          ///< standard deviation of a voxel
  CtSampling sampling = {};       ///< of the CT
  double edge_hu_per_mm = 0.0;    ///< slope of the CT numbers at the surface: median
  double noise_part_mm = 0.0;     ///< standard error by the noise, over the slope
  double sampling_part_mm = 0.0;  ///< and by partial volume in the voxels: root mean square over the bone's surface
  double curved_part_mm = 0.0;    ///< and by how voxels of over 0.45 mm round off a wall that bends, likewise

  /// Root mean square over the bone's surface.
  double standard_error_mm() const;
  /// Of a wall with this normal (unit, patient LPS, either sign); of a normal that is zero, as above.
  double standard_error_mm(const Vec3& normal) const;
  /// Where a clearance (mm) to a wall with this normal lies, the surface being known no better. Throws Error on a
  /// confidence not between 0 and 1.
  Interval band(double clearance_mm, const Vec3& normal = Vec3::Zero(), double confidence = 0.95) const;
};

/// `edge_slopes_hu_per_mm`: slopes of the CT numbers at many places of the surface; `normals`: the surface's there, or
/// at other places that stand for it. Throws Error on noise below 0, on voxels not above 0, on slices whose thickness
/// is below 0, without slopes or normals, and where half of the slopes are not above 0.
CtSurfaceError ct_surface_error(double noise_hu, const CtSampling& sampling,
                                std::span<const double> edge_slopes_hu_per_mm, std::span<const Vec3> normals);

}  // namespace spinaltap
