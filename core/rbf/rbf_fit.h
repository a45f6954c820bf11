#pragma once

#include "core/base/progress.h"
#include "core/rbf/rbf_field.h"
#include "core/surface/surface_points.h"

namespace spinaltap {

/// Interpolates values (mm) at points (mm): solves the dense system [A P; P' 0][w; a] = [f; 0] with A_ij = |x_i - x_j|
/// (Carr et al. 2001, equation 9). `smoothing` (mm) is subtracted from A's diagonal: 0 interpolates, more lets the
/// surface miss noisy points (their section 5; A is negative definite on the weights that the side conditions allow).
/// Points must differ unless they are smoothed. Throws Error on fewer than 4, over 20,000, coplanar or equal points,
/// and on numbers that are not finite.
RbfField interpolate_rbf(std::span<const Vec3> points_mm, std::span<const double> values_mm, double smoothing_mm = 0.0);

struct RbfFitOptions {
  std::size_t max_surface_centres = 1400;  ///< up to twice as many off-surface centres come on top
  double tolerance_mm = 0.05;              ///< points that the surface misses by more become centres
  double off_surface_mm = 1.0;             ///< distance of an off-surface centre, shortened where another part is near
  double smoothing_mm = 0.0;
};

/// What the fit came to.
struct RbfFitReport {
  std::size_t points = 0;  ///< surface points given
  std::size_t surface_centres = 0;
  std::size_t off_surface_centres = 0;
  int rounds = 0;
  double mean_residual_mm = 0.0;  ///< |s| at all given points
  double p99_residual_mm = 0.0;
  double max_residual_mm = 0.0;
};

struct RbfFit {
  RbfField field;
  RbfFitReport report;
};

/// A surface through a few thousand well-spread centres: a Poisson-disc subset first, then, round by round, the points
/// that the surface misses most (greedy centre selection, Carr et al. 2001, section 4). Each surface centre brings two
/// off-surface ones along its normal, outside and inside: with both, the surface centre's own weight almost vanishes,
/// and with it the dimple that |x - c| makes there. Throws Error when there are too few points, when a position or a
/// normal is not finite, and when no normal leads away from the surface.
RbfFit fit_surface_rbf(const SurfacePoints& surface, const RbfFitOptions& options = {}, const Progress& progress = {});

}  // namespace spinaltap
