#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/rbf/rbf_model.h"

namespace spinaltap {

/// What a radial basis function is fitted to.
struct RbfValues {
  std::vector<Vec3> points_mm;        ///< patient LPS
  std::vector<double> values_mm;      ///< one a point: signed distance, negative inside
  std::vector<double> error_bars_mm;  ///< empty, or one a point: how far the fit may stay from the value there
};

struct FitOptions {
  RadialKernel kernel = RadialKernel::biharmonic;
  double accuracy_mm = 0.01;  ///< largest difference, at any point, from what the equations ask there
  double smoothing_mm = 0.0;  ///< lets the fit miss each value by this times the point's weight; 0 interpolates
  double reduction_mm = 0.0;  ///< 0: every point is a centre; else as few as keep all points within this (greedy),
                              ///< with smoothing within this of the smooth fit to all points
  std::size_t slabs = 1;      ///< choose centres slab by slab of z, as the paper did (its 3.2.2); needs reduction_mm
  double merge_mm = 1e-3;     ///< points nearer to each other than this become one, with their mean value
};

/// What a fit came to.
struct FitReport {
  std::size_t points = 0;         ///< given
  std::size_t merged_points = 0;  ///< of those, taken into another
  std::size_t centres = 0;
  int rounds = 0;                ///< of choosing centres; 1 when every point is one
  int iterations = 0;            ///< of the solver, in all rounds
  double max_residual_mm = 0.0;  ///< |s - value| at all given points: below accuracy_mm for a plain fit
  double mean_residual_mm = 0.0;
};

struct RbfFit {
  RbfModel model;
  FitReport report;
};

/// Fits a radial basis function; see docs/rbf.md. With error bars: the smoothest function that stays within them.
/// Throws Error on fewer points than polynomial terms, on points in a plane (or, for the triharmonic kernel, on a
/// quadric), on numbers that are not finite and options out of range; Cancelled.
RbfFit fit_rbf(const RbfValues& data, const FitOptions& options = {}, const Progress& progress = {});

namespace detail {

/// The same without the residuals of its report, for callers that read their own.
RbfFit fit_without_residuals(const RbfValues& data, const FitOptions& options, const Progress& progress);

}  // namespace detail
}  // namespace spinaltap
