#include "core/rbf/fit_error_bars.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/rbf/detail/polynomial.h"
#include "core/rbf/fit_rbf.h"
#include "tests/unit/core/rbf/kernels.h"
#include "tests/unit/core/rbf/plain_sum.h"
#include "tests/unit/core/rbf/point_sets.h"

namespace spinaltap {
namespace {

using test::kKernels;

constexpr std::uint64_t kErrorBarSeed = 151;
constexpr double kBarAccuracyMm = 1e-4;

/// A smooth function with noise of at most 0.1 mm, and bars of three widths.
RbfValues values_with_bars(std::size_t count) {
  RbfValues data{test::random_points(count, kErrorBarSeed), {}, {}};
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3& p = data.points_mm[i];
    data.values_mm.push_back(std::sin(0.3 * p.x()) + 0.1 * p.y() * std::cos(0.25 * p.z()) +
                             0.1 * (2.0 * random_uniform(kErrorBarSeed + 1, i) - 1.0));
    data.error_bars_mm.push_back(i % 3 == 0 ? 0.1 : i % 3 == 1 ? 0.15 : 0.3);
  }
  return data;
}

detail::ReducedFit fit_bars(RadialKernel kernel, const RbfValues& data) {
  return detail::fit_error_bars(kernel, data.points_mm, data.values_mm, data.error_bars_mm, kBarAccuracyMm, {});
}

/// w'Aw with the sign that makes it positive: the kernel's norm, squared.
double norm_of(const RbfModel& model) {
  double sum = 0.0;
  for (std::size_t i = 0; i < model.weights.size(); ++i) {
    sum += model.weights[i] *
           test::plain_sum(model.kernel, 0.0, model.centres_mm, model.weights, model.centres_mm[i]).value;
  }
  return model.kernel == RadialKernel::biharmonic ? -sum : sum;
}

TEST(FitErrorBars, StaysWithinAllOfThem) {
  SCOPED_TRACE(::testing::Message() << "seed " << kErrorBarSeed);
  const RbfValues data = values_with_bars(900);
  for (const RadialKernel kernel : kKernels) {
    const RbfModel model = fit_bars(kernel, data).model;
    EXPECT_LT(model.centres_mm.size(), 900U);
    for (std::size_t i = 0; i < 900; ++i) {
      EXPECT_LE(std::abs(test::plain_value(model, data.points_mm[i]) - data.values_mm[i]),
                data.error_bars_mm[i] + kBarAccuracyMm);
    }
  }
}

TEST(FitErrorBars, BendsLessThanOtherFitsWithinTheBars) {
  SCOPED_TRACE(::testing::Message() << "seed " << kErrorBarSeed);
  RbfValues data = values_with_bars(900);
  data.error_bars_mm.assign(900, 0.2);
  RbfValues plain = data;
  plain.error_bars_mm.clear();
  for (const RadialKernel kernel : kKernels) {
    const double bars = norm_of(fit_bars(kernel, data).model);
    const double all = norm_of(fit_rbf(plain, {.kernel = kernel, .accuracy_mm = kBarAccuracyMm}).model);
    const double reduced =
        norm_of(fit_rbf(plain, {.kernel = kernel, .accuracy_mm = kBarAccuracyMm, .reduction_mm = 0.2}).model);
    // Both others stay within the bars too and meet the determining points, so that none can bend less.
    EXPECT_GT(bars, 0.0);
    EXPECT_LT(bars, reduced);
    EXPECT_LT(reduced, all);
  }
}

TEST(FitErrorBars, PullsOutwardsAtTheEndsOfBarsAndNowhereElse) {
  SCOPED_TRACE(::testing::Message() << "seed " << kErrorBarSeed);
  const RbfValues data = values_with_bars(900);
  for (const RadialKernel kernel : kKernels) {
    const detail::ReducedFit fit = fit_bars(kernel, data);
    const std::vector<std::uint32_t> determining = detail::determining_points(kernel, data.points_mm);
    std::size_t ends = 0;
    for (std::size_t k = 0; k < fit.centres.size(); ++k) {
      const std::uint32_t i = fit.centres[k];
      if (std::find(determining.begin(), determining.end(), i) != determining.end()) continue;
      const double off_mm = test::plain_value(fit.model, data.points_mm[i]) - data.values_mm[i];
      EXPECT_NEAR(std::abs(off_mm), data.error_bars_mm[i], kBarAccuracyMm) << "centre " << k;
      // The norm must fall when the bar is widened: d(norm)/d(value) = 2 w, minus that for the biharmonic kernel.
      const double rise = (kernel == RadialKernel::biharmonic ? -1.0 : 1.0) * fit.model.weights[k];
      EXPECT_LE(rise * off_mm, 0.0) << "centre " << k;
      ++ends;
    }
    EXPECT_GT(ends, 10U);
  }
}

TEST(FitErrorBars, InterpolatesWhereABarHasNoWidth) {
  SCOPED_TRACE(::testing::Message() << "seed " << kErrorBarSeed);
  RbfValues data = values_with_bars(300);
  for (std::size_t i = 0; i < 300; i += 5) data.error_bars_mm[i] = 0.0;
  const RbfFit some = fit_rbf(data, {.accuracy_mm = kBarAccuracyMm});
  for (std::size_t i = 0; i < 300; i += 5) {
    EXPECT_NEAR(test::plain_value(some.model, data.points_mm[i]), data.values_mm[i], kBarAccuracyMm);
  }
  data.error_bars_mm.assign(300, 0.0);
  const RbfFit all = fit_rbf(data, {.accuracy_mm = kBarAccuracyMm});
  data.error_bars_mm.clear();
  const RbfFit plain = fit_rbf(data, {.accuracy_mm = kBarAccuracyMm});
  EXPECT_EQ(all.report.centres, 300U);
  for (std::uint64_t n = 0; n < 50; ++n) {
    const Vec3 p = test::random_place(kErrorBarSeed + 2, n);
    EXPECT_NEAR(test::plain_value(all.model, p), test::plain_value(plain.model, p), 20.0 * kBarAccuracyMm);
  }
}

TEST(FitErrorBars, IsThePlaneWhenBarsHoldOne) {
  SCOPED_TRACE(::testing::Message() << "seed " << kErrorBarSeed);
  RbfValues data{test::random_points(500, kErrorBarSeed), {}, std::vector<double>(500, 0.5)};
  for (const Vec3& p : data.points_mm) data.values_mm.push_back(1.0 + 0.3 * p.x() - 0.2 * p.z());
  const detail::ReducedFit fit = fit_bars(RadialKernel::biharmonic, data);
  for (const double weight : fit.model.weights) EXPECT_NEAR(weight, 0.0, 1e-12);
}

TEST(FitErrorBars, TakesTheNarrowestBarOfPointsThatAreOne) {
  RbfValues data = values_with_bars(100);
  data.points_mm.push_back(data.points_mm[50]);
  data.values_mm.push_back(data.values_mm[50]);
  data.error_bars_mm.push_back(0.0);
  const RbfFit fit = fit_rbf(data, {.accuracy_mm = kBarAccuracyMm});
  EXPECT_EQ(fit.report.merged_points, 1U);
  EXPECT_NEAR(test::plain_value(fit.model, data.points_mm[50]), data.values_mm[50], kBarAccuracyMm);
}

}  // namespace
}  // namespace spinaltap
