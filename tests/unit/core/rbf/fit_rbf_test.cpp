// Compiled with optimisation: long loops of its own.

#include "core/rbf/fit_rbf.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>

#include "core/rbf/rbf_field.h"
#include "tests/support/test_kind.h"
#include "tests/unit/core/rbf/dense_solution.h"
#include "tests/unit/core/rbf/kernels.h"
#include "tests/unit/core/rbf/plain_sum.h"
#include "tests/unit/core/rbf/point_sets.h"
#include "tests/unit/core/rbf/vertebra_points.h"

namespace spinaltap {
namespace {

using test::kKernels;

constexpr std::uint64_t kFitSeed = 1729;

/// Something smooth that is not linear.
double wavy(const Vec3& p) { return std::sin(0.3 * p.x()) + 0.2 * p.y() * std::cos(0.25 * p.z()); }

template <class Function>
RbfValues values_of(const std::vector<Vec3>& points_mm, const Function& function) {
  RbfValues data{points_mm, {}, {}};
  for (const Vec3& p : points_mm) data.values_mm.push_back(function(p));
  return data;
}

double worst_residual(const RbfModel& model, const RbfValues& data) {
  double worst_mm = 0.0;
  for (std::size_t i = 0; i < data.points_mm.size(); ++i) {
    worst_mm = std::max(worst_mm, std::abs(test::plain_value(model, data.points_mm[i]) - data.values_mm[i]));
  }
  return worst_mm;
}

SLOW_TESTS("FitRbf.PassesThroughAVertebrasPointsOnPixels", "FitRbf.PassesThroughItsDataToTheAccuracyAsked");

TEST(FitRbf, PassesThroughItsDataToTheAccuracyAsked) {
  SCOPED_TRACE(::testing::Message() << "seed " << kFitSeed);
  const RbfValues data = values_of(test::random_points(1500, kFitSeed), wavy);
  for (const RadialKernel kernel : kKernels) {
    for (const double accuracy_mm : {1e-1, 1e-3, 1e-7}) {
      const RbfFit fit = fit_rbf(data, {.kernel = kernel, .accuracy_mm = accuracy_mm});
      EXPECT_LT(worst_residual(fit.model, data), accuracy_mm);
      EXPECT_LE(fit.report.max_residual_mm, accuracy_mm);
      EXPECT_EQ(fit.report.points, 1500U);
      EXPECT_EQ(fit.report.merged_points, 0U);
      EXPECT_EQ(fit.report.centres, 1500U);
      EXPECT_EQ(fit.report.rounds, 1);
      EXPECT_GT(fit.report.iterations, 0);
    }
  }
}

TEST(FitRbf, PassesThroughAVertebrasPointsOnPixels) {
  RbfValues data = test::vertebra_values(4.0);
  for (const RadialKernel kernel : kKernels) {
    // The triharmonic kernel takes longer: a third of the points.
    if (kernel == RadialKernel::triharmonic) {
      RbfValues third;
      for (std::size_t i = 0; i < data.points_mm.size(); i += 3) {
        third.points_mm.push_back(data.points_mm[i]);
        third.values_mm.push_back(data.values_mm[i]);
      }
      data = third;
    }
    const RbfFit fit = fit_rbf(data, {.kernel = kernel, .accuracy_mm = 0.01});
    double worst_mm = 0.0;
    // Points that pixels made one have values that agree, but for off-surface points with other normals.
    for (std::size_t i = 0; i < fit.model.centres_mm.size(); i += 5) {
      double nearest_mm = 1e9;
      for (std::size_t j = 0; j < data.points_mm.size(); ++j) {
        if ((data.points_mm[j] - fit.model.centres_mm[i]).norm() > 1e-3) continue;
        const double value_mm = test::plain_value(fit.model, data.points_mm[j]);
        nearest_mm = std::min(nearest_mm, std::abs(value_mm - data.values_mm[j]));
      }
      worst_mm = std::max(worst_mm, nearest_mm);
    }
    EXPECT_LT(worst_mm, 0.01);
    EXPECT_EQ(fit.report.centres + fit.report.merged_points, fit.report.points);
    EXPECT_LT(fit.report.iterations, 60);
  }
}

TEST(FitRbf, IsWhatADenseSolverFinds) {
  SCOPED_TRACE(::testing::Message() << "seed " << kFitSeed);
  const RbfValues data = values_of(test::random_points(250, kFitSeed), wavy);
  for (const RadialKernel kernel : kKernels) {
    for (const double smoothing_mm : {0.0, 1.0}) {
      const RbfFit fit = fit_rbf(data, {.kernel = kernel, .accuracy_mm = 1e-8, .smoothing_mm = smoothing_mm});
      const RbfModel dense = test::dense_solution(kernel, data.points_mm, data.values_mm, smoothing_mm);
      for (std::uint64_t n = 0; n < 100; ++n) {
        const Vec3 p = test::random_place(kFitSeed + 1, n, 12.0);
        // What is 1e-8 at the points may be some tens of that between and beyond them.
        EXPECT_NEAR(test::plain_value(fit.model, p), test::plain_value(dense, p), 1e-6);
      }
    }
  }
}

TEST(FitRbf, ReproducesItsPolynomialsEverywhere) {
  SCOPED_TRACE(::testing::Message() << "seed " << kFitSeed);
  const Vec3 slope(0.7, -1.3, 0.4);
  const auto linear = [&](const Vec3& p) { return 2.5 + slope.dot(p); };
  const auto quadratic = [&](const Vec3& p) {
    return linear(p) + 0.03 * p.x() * p.x() - 0.05 * p.x() * p.y() + 0.02 * p.y() * p.z() - 0.01 * p.z() * p.z();
  };
  for (const RadialKernel kernel : kKernels) {
    const auto expected = [&](const Vec3& p) { return kernel == RadialKernel::biharmonic ? linear(p) : quadratic(p); };
    const RbfFit fit = fit_rbf(values_of(test::random_points(200, kFitSeed), expected), {.kernel = kernel});
    for (std::uint64_t n = 0; n < 100; ++n) {
      const Vec3 p = test::random_place(kFitSeed + 1, n, 40.0);          // also far from the data
      EXPECT_NEAR(test::plain_value(fit.model, p), expected(p), 1e-10);  // rounding of values near 100
    }
  }
}

TEST(FitRbf, ComesNearASmoothFunctionBetweenItsData) {
  SCOPED_TRACE(::testing::Message() << "seed " << kFitSeed);
  const RbfValues data = values_of(test::random_points(1000, kFitSeed), wavy);
  double last = 0.1;  // points 2 mm apart against waves of 21 mm; the function spans +-3
  for (const RadialKernel kernel : kKernels) {
    const RbfFit fit = fit_rbf(data, {.kernel = kernel, .accuracy_mm = 1e-4});
    double worst = 0.0;
    for (std::uint64_t n = 0; n < 300; ++n) {
      const Vec3 p = test::random_place(kFitSeed + 2, n, 8.0);
      worst = std::max(worst, std::abs(test::plain_value(fit.model, p) - wavy(p)));
    }
    EXPECT_LT(worst, last);
    last = worst;  // the triharmonic kernel comes nearer to smooth functions
  }
}

TEST(FitRbf, DoesNotCareHowItsDataAreTurnedAndShifted) {
  SCOPED_TRACE(::testing::Message() << "seed " << kFitSeed);
  const RbfValues data = values_of(test::random_points(300, kFitSeed), wavy);
  const Mat3 turn = Eigen::AngleAxisd(1.1, Vec3(2, -1, 3).normalized()).toRotationMatrix();
  const Vec3 shift_mm(-300.0, 800.0, 1200.0);
  RbfValues moved = data;
  for (Vec3& p : moved.points_mm) p = turn * p + shift_mm;
  for (const RadialKernel kernel : kKernels) {
    const FitOptions options{.kernel = kernel, .accuracy_mm = 1e-8};
    const RbfModel here = fit_rbf(data, options).model;
    const RbfModel there = fit_rbf(moved, options).model;
    for (std::uint64_t n = 0; n < 100; ++n) {
      const Vec3 p = test::random_place(kFitSeed + 4, n, 12.0);
      // Twice the accuracy, times some tens beside the points.
      EXPECT_NEAR(test::plain_value(there, turn * p + shift_mm), test::plain_value(here, p), 1e-6);
    }
  }
}

TEST(FitRbf, GivesTheSameBitsAtAnyNumberOfThreadsAndEachTime) {
  const RbfValues all = test::vertebra_values(6.0);
  RbfValues data;  // every other point
  for (std::size_t i = 0; i < all.points_mm.size(); i += 2) {
    data.points_mm.push_back(all.points_mm[i]);
    data.values_mm.push_back(all.values_mm[i]);
  }
  for (const FitOptions& options : {FitOptions{}, FitOptions{.smoothing_mm = 0.1, .reduction_mm = 0.2},
                                    FitOptions{.reduction_mm = 0.3, .slabs = 3}}) {
    const auto fit = [&](std::size_t threads) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      return fit_rbf(data, options).model;
    };
    const RbfModel one = fit(1);
    for (const RbfModel& other : {fit(2), fit(2)}) {
      EXPECT_EQ(other.weights, one.weights);
      EXPECT_EQ(other.centres_mm, one.centres_mm);
      EXPECT_EQ(other.polynomial, one.polynomial);
    }
  }
}

TEST(FitRbf, TakesPointsThatAreNearlyTheSameAsOneWithTheirMeanValue) {
  SCOPED_TRACE(::testing::Message() << "seed " << kFitSeed);
  RbfValues data = values_of(test::random_points(100, kFitSeed), wavy);
  for (const Vec3& beside_mm : {Vec3(0, 0, 0), Vec3(5e-4, 0, 0)}) {
    data.points_mm.emplace_back(data.points_mm[7] + beside_mm);
    data.values_mm.push_back(data.values_mm[7] + 0.3);
  }
  const RbfFit fit = fit_rbf(data, {.accuracy_mm = 1e-6});
  EXPECT_EQ(fit.report.points, 102U);
  EXPECT_EQ(fit.report.merged_points, 2U);
  EXPECT_EQ(fit.report.centres, 100U);
  // The mean of three values, two of them 0.3 mm higher.
  EXPECT_NEAR(test::plain_value(fit.model, data.points_mm[7]), data.values_mm[7] + 0.2, 1e-6);
  // Told honestly: the first of the three is missed by 0.2 mm.
  EXPECT_NEAR(fit.report.max_residual_mm, 0.2, 1e-5);
  EXPECT_NEAR(fit.report.mean_residual_mm, 0.4 / 102.0, 1e-5);
}

TEST(FitRbf, KeepsNearPointsApartWhenNoneAreToBeMerged) {
  SCOPED_TRACE(::testing::Message() << "seed " << kFitSeed);
  RbfValues data = values_of(test::random_points(100, kFitSeed), wavy);
  data.points_mm.emplace_back(data.points_mm[7] + Vec3(5e-4, 0, 0));
  data.values_mm.push_back(data.values_mm[7] + 1e-4);
  const RbfFit fit = fit_rbf(data, {.accuracy_mm = 1e-6, .merge_mm = 0.0});
  EXPECT_EQ(fit.report.merged_points, 0U);
  EXPECT_LT(worst_residual(fit.model, data), 1e-6);
}

TEST(FitRbf, TakesThingsOfAnySize) {
  SCOPED_TRACE(::testing::Message() << "seed " << kFitSeed);
  const std::vector<Vec3> unit = test::random_points(400, kFitSeed, 1.0);
  for (const RadialKernel kernel : kKernels) {
    for (const double reach_mm : {1e-3, 1.0, 1e5}) {
      SCOPED_TRACE(::testing::Message() << "reach " << reach_mm << " mm");
      RbfValues data;
      for (const Vec3& p : unit) {
        data.points_mm.emplace_back(reach_mm * p);
        data.values_mm.push_back(reach_mm * wavy(10.0 * p));
      }
      const double accuracy_mm = 1e-6 * reach_mm;
      const RbfFit fit = fit_rbf(data, {.kernel = kernel, .accuracy_mm = accuracy_mm, .merge_mm = 1e-3 * reach_mm});
      EXPECT_LT(worst_residual(fit.model, data), accuracy_mm);
    }
  }
}

TEST(FitRbf, ReadsItsValuesWithoutAskingForGradientsAsFine) {
  SCOPED_TRACE(::testing::Message() << "seed " << kFitSeed);
  // More centres than are summed term by term: in a cube of 2e-3 mm gradients are far coarser numbers than values.
  RbfValues data =
      values_of(test::random_points(2200, kFitSeed, 1e-3), [](const Vec3& p) { return 1e-3 * wavy(1e4 * p); });
  const RbfFit fit = fit_rbf(data, {.accuracy_mm = 1e-9, .merge_mm = 0.0});
  EXPECT_LE(fit.report.max_residual_mm, 1e-9);
  data.error_bars_mm.assign(2200, 1e-4);
  EXPECT_LE(fit_rbf(data, {.accuracy_mm = 1e-8, .merge_mm = 0.0}).report.max_residual_mm, 1e-4 + 1e-8);
}

TEST(FitRbf, TakesFarClustersThatAreVeryDense) {
  SCOPED_TRACE(::testing::Message() << "seed " << kFitSeed);
  // Two heaps of 1 mm, 1,000 m apart, and one of 0.01 mm.
  std::vector<Vec3> points_mm = test::random_points(100, kFitSeed, 1.0);
  for (const Vec3& p : test::random_points(100, kFitSeed + 1, 1.0)) points_mm.emplace_back(Vec3(1e6, 0, 0) + p);
  for (const Vec3& p : test::random_points(100, kFitSeed + 2, 0.01)) points_mm.emplace_back(Vec3(0, 50, 0) + p);
  const RbfValues data = values_of(points_mm, [](const Vec3& p) { return 1.0 + std::sin(0.1 * p.y() + p.z()); });
  const RbfFit fit = fit_rbf(data, {.accuracy_mm = 1e-3, .merge_mm = 0.0});
  EXPECT_LT(worst_residual(fit.model, data), 1e-3);
}

}  // namespace
}  // namespace spinaltap
