#include "core/rbf/fit_rbf.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/rbf/detail/rbf_solver.h"
#include "core/rbf/fit_error_bars.h"
#include "core/rbf/merge_points.h"
#include "core/rbf/rbf_field.h"
#include "core/rbf/reduce_centres.h"

namespace spinaltap {
namespace {

void check(const RbfValues& data, const FitOptions& options) {
  const std::size_t count = data.points_mm.size();
  constexpr std::size_t kMaxPoints = 50'000'000;
  if (count < polynomial_terms(options.kernel) || count > kMaxPoints) {
    fail("RBF: expected ", polynomial_terms(options.kernel), " to ", kMaxPoints, " points, found ", count);
  }
  if (data.values_mm.size() != count) {
    fail("RBF: expected a value for each of ", count, " points, found ", data.values_mm.size());
  }
  if (!data.error_bars_mm.empty() && data.error_bars_mm.size() != count) {
    fail("RBF: expected an error bar for each of ", count, " points or none, found ", data.error_bars_mm.size());
  }
  constexpr double kFarthestMm = 1e7;
  for (std::size_t i = 0; i < count; ++i) {
    if (!(data.points_mm[i].array().abs() <= kFarthestMm).all() || !(std::abs(data.values_mm[i]) <= kFarthestMm)) {
      fail("RBF: expected numbers of at most ", kFarthestMm, " mm, found something else at point ", i + 1);
    }
    if (!data.error_bars_mm.empty() && !(data.error_bars_mm[i] >= 0.0 && data.error_bars_mm[i] <= kFarthestMm)) {
      fail("RBF: expected an error bar of 0 mm or more at point ", i + 1, ", found ", data.error_bars_mm[i]);
    }
  }
  const auto not_negative = [](double value, const char* name) {
    if (!(value >= 0.0) || !std::isfinite(value)) fail("RBF: expected ", name, " of 0 mm or more, found ", value);
  };
  if (!(options.accuracy_mm > 0.0) || !std::isfinite(options.accuracy_mm)) {
    fail("RBF: expected an accuracy above 0 mm, found ", options.accuracy_mm);
  }
  not_negative(options.smoothing_mm, "smoothing");
  not_negative(options.reduction_mm, "a tolerance of reduction");
  not_negative(options.merge_mm, "a merging distance");
  if (options.slabs < 1) fail("RBF: expected 1 slab or more, found 0");
  if (options.slabs > 1 && options.reduction_mm == 0.0) fail("RBF: slabs are for reduction; expected its tolerance");
  if (!data.error_bars_mm.empty() && (options.smoothing_mm > 0.0 || options.reduction_mm > 0.0)) {
    fail("RBF: expected error bars, or smoothing and reduction, not both");
  }
}

/// The data with points that are nearly the same taken together: the first one's place, the mean of the values, the
/// narrowest error bar.
RbfValues merged(const RbfValues& data, double merge_mm) {
  const std::vector<std::uint32_t> stands_for = detail::merge_points(data.points_mm, merge_mm);
  std::vector<std::size_t> place(stands_for.size());
  std::vector<double> members;
  RbfValues result;
  for (std::size_t i = 0; i < stands_for.size(); ++i) {
    if (stands_for[i] == i) {
      place[i] = result.points_mm.size();
      result.points_mm.push_back(data.points_mm[i]);
      result.values_mm.push_back(data.values_mm[i]);
      if (!data.error_bars_mm.empty()) result.error_bars_mm.push_back(data.error_bars_mm[i]);
      members.push_back(1.0);
      continue;
    }
    const std::size_t to = place[stands_for[i]];
    members[to] += 1.0;
    result.values_mm[to] += (data.values_mm[i] - result.values_mm[to]) / members[to];
    if (!data.error_bars_mm.empty()) {
      result.error_bars_mm[to] = std::min(result.error_bars_mm[to], data.error_bars_mm[i]);
    }
  }
  return result;
}

/// How far the model is from the values at all given points.
void measure(const RbfModel& model, const RbfValues& data, double accuracy_mm, FitReport& report) {
  std::vector<double> found_mm(data.points_mm.size());
  RbfField::for_values(model, accuracy_mm).evaluate(data.points_mm, found_mm, {});
  double sum_mm = 0.0;
  for (std::size_t i = 0; i < found_mm.size(); ++i) {
    const double difference_mm = std::abs(found_mm[i] - data.values_mm[i]);
    sum_mm += difference_mm;
    report.max_residual_mm = std::max(report.max_residual_mm, difference_mm);
  }
  report.mean_residual_mm = sum_mm / static_cast<double>(found_mm.size());
}

}  // namespace

RbfFit detail::fit_without_residuals(const RbfValues& data, const FitOptions& options, const Progress& progress) {
  check(data, options);
  RbfValues points = merged(data, options.merge_mm);
  RbfFit fit;
  fit.report.points = data.points_mm.size();
  fit.report.merged_points = data.points_mm.size() - points.points_mm.size();
  const auto take = [&](detail::ReducedFit&& reduced) {
    fit.model = std::move(reduced.model);
    fit.report.rounds = reduced.rounds;
    fit.report.iterations += reduced.iterations;
  };
  if (!points.error_bars_mm.empty()) {
    take(detail::fit_error_bars(options.kernel, points.points_mm, points.values_mm, points.error_bars_mm,
                                options.accuracy_mm, progress));
  } else {
    // Reduction without smoothing has no use for the fit to all points.
    if (options.reduction_mm == 0.0 || options.smoothing_mm > 0.0) {
      std::vector<double> smoothing_mm;
      if (options.smoothing_mm > 0.0) smoothing_mm.assign(points.points_mm.size(), options.smoothing_mm);
      detail::RbfSolution solution = detail::RbfSolver(options.kernel, points.points_mm, std::move(smoothing_mm))
                                         .solve(points.values_mm, options.accuracy_mm, {}, progress);
      fit.model = std::move(solution.model);
      fit.report.rounds = 1;
      fit.report.iterations = solution.iterations;
    }
    if (options.reduction_mm > 0.0) {
      const double accuracy_mm = std::min(options.accuracy_mm, 0.1 * options.reduction_mm);
      if (options.smoothing_mm > 0.0) {
        RbfField::for_values(fit.model, accuracy_mm).evaluate(points.points_mm, points.values_mm, {});
      }
      take(options.slabs == 1
               ? detail::reduce_centres(options.kernel, points.points_mm, points.values_mm, options.reduction_mm,
                                        accuracy_mm, progress)
               : detail::reduce_centres_in_slabs(options.kernel, points.points_mm, points.values_mm, options.slabs,
                                                 options.reduction_mm, accuracy_mm, progress));
    }
  }
  fit.report.centres = fit.model.weights.size();
  return fit;
}

RbfFit fit_rbf(const RbfValues& data, const FitOptions& options, const Progress& progress) {
  RbfFit fit = detail::fit_without_residuals(data, options, progress);
  measure(fit.model, data, 0.1 * options.accuracy_mm, fit.report);
  return fit;
}

}  // namespace spinaltap
