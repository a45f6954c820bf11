#pragma once

#include "core/base/progress.h"
#include "core/rbf/rbf_field.h"
#include "core/surface/surface_options.h"
#include "core/surface/surface_points.h"

namespace spinaltap {

/// What the fit came to.
struct SurfaceFitReport {
  std::size_t points = 0;  ///< surface points given
  std::size_t off_surface_points = 0;
  std::size_t centres = 0;
  int iterations = 0;
  double mean_residual_mm = 0.0;  ///< |s| at all given points
  double p99_residual_mm = 0.0;
  double max_residual_mm = 0.0;
};

struct SurfaceFit {
  RbfField field;
  SurfaceFitReport report;
};

/// A surface through points spread evenly over those given: their values are 0, and each brings two off-surface points
/// along its normal, outside and inside, with their distance as the value (Carr et al. 2001, section 2). With both, a
/// surface point's own weight almost vanishes, and with it the dimple that |x - c| makes there. Throws Error when there
/// are too few points, when a position or a normal is not finite, and when no normal leads away from the surface.
SurfaceFit fit_surface(const SurfacePoints& surface, const SurfaceFitOptions& options = {},
                       const Progress& progress = {});

}  // namespace spinaltap
