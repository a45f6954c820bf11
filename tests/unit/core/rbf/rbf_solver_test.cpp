// Compiled with optimisation: long loops of its own.

#include "core/rbf/detail/rbf_solver.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "core/base/error.h"
#include "tests/support/error_of.h"
#include "tests/support/test_kind.h"
#include "tests/unit/core/rbf/dense_solution.h"
#include "tests/unit/core/rbf/kernels.h"
#include "tests/unit/core/rbf/plain_sum.h"
#include "tests/unit/core/rbf/point_sets.h"

namespace spinaltap::detail {
namespace {

using test::kKernels;

constexpr std::uint64_t kSolverSeed = 113;

const char* name_of(RadialKernel kernel) { return kernel == RadialKernel::biharmonic ? "biharmonic" : "triharmonic"; }

double norm_of(const std::vector<double>& v) {
  return Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size())).norm();
}

SLOW_TESTS("RbfSolver.MeetsItsEquationsToTheAccuracyAsked");

TEST(RbfSolver, FindsWhatADenseSolverFinds) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSolverSeed);
  for (const RadialKernel kernel : kKernels) {
    for (const double smoothing_mm : {0.0, 0.1, 20.0}) {
      for (const std::size_t count : {polynomial_terms(kernel) + 1, std::size_t{45}, std::size_t{300}}) {
        SCOPED_TRACE(::testing::Message() << name_of(kernel) << ", smoothing " << smoothing_mm << ", " << count);
        const std::vector<Vec3> points_mm = test::random_points(count, kSolverSeed);
        const std::vector<double> values_mm = test::random_weights(count, kSolverSeed + 1);
        std::vector<double> smoothing;
        if (smoothing_mm > 0.0) smoothing.assign(count, smoothing_mm);
        constexpr double kAccuracyMm = 1e-7;
        const RbfModel found = RbfSolver(kernel, points_mm, smoothing).solve(values_mm, kAccuracyMm).model;
        const RbfModel dense = test::dense_solution(kernel, points_mm, values_mm, smoothing_mm);
        std::vector<double> difference;
        for (std::size_t i = 0; i < count; ++i) difference.push_back(found.weights[i] - dense.weights[i]);
        // Values are random numbers of about 1, and 1e-7 is what they are met to; the inverse, restricted, is as large
        // for the residual as for the values, or ten times that.
        EXPECT_LT(norm_of(difference), 1e-5 * norm_of(dense.weights));
        for (std::uint64_t n = 0; n < 50; ++n) {
          const Vec3 p = test::random_place(kSolverSeed + 2, n);
          EXPECT_NEAR(test::plain_value(found, p), test::plain_value(dense, p), 1e-5);
        }
      }
    }
  }
}

TEST(RbfSolver, MeetsItsEquationsToTheAccuracyAsked) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSolverSeed);
  const std::vector<std::vector<Vec3>> sets{test::random_points(1500, kSolverSeed), test::ball_points(1500),
                                            test::clustered_points(1500, kSolverSeed)};
  for (const RadialKernel kernel : kKernels) {
    for (std::size_t set = 0; set < sets.size(); ++set) {
      // A ball is a quadric. Values of a few mm on the smallest cluster, 1e-4 mm wide, are no smooth function.
      if (kernel == RadialKernel::triharmonic && set > 0) continue;
      const std::vector<Vec3>& points_mm = sets[set];
      std::vector<double> values_mm;
      values_mm.reserve(points_mm.size());
      for (const Vec3& p : points_mm) values_mm.push_back(std::sin(0.5 * p.x()) + 0.1 * p.y() * p.z());
      for (const double accuracy_mm : {1e-2, 1e-6}) {
        SCOPED_TRACE(::testing::Message() << name_of(kernel) << ", set " << set << ", accuracy " << accuracy_mm);
        const std::vector<double> smoothing_mm = test::random_weights(points_mm.size(), kSolverSeed + 7);
        std::vector<double> magnitudes_mm;
        magnitudes_mm.reserve(smoothing_mm.size());
        for (const double s : smoothing_mm) magnitudes_mm.push_back(0.1 * std::abs(s));
        const RbfSolution solution = RbfSolver(kernel, points_mm, magnitudes_mm).solve(values_mm, accuracy_mm);
        const double sign = kernel == RadialKernel::biharmonic ? -1.0 : 1.0;
        double worst_mm = 0.0;
        double sum = 0.0;
        double size = 0.0;
        Vec3 moment = Vec3::Zero();
        for (std::size_t i = 0; i < points_mm.size(); ++i) {
          const double weight = solution.model.weights[i];
          worst_mm = std::max(worst_mm, std::abs(test::plain_value(solution.model, points_mm[i]) +
                                                 sign * magnitudes_mm[i] * weight - values_mm[i]));
          sum += weight;
          moment += weight * points_mm[i];
          size += std::abs(weight);
        }
        EXPECT_LT(worst_mm, accuracy_mm);
        EXPECT_LE(solution.max_residual_mm + solution.sum_error_mm, accuracy_mm);
        EXPECT_LT(std::abs(sum), 1e-12 * size);  // the side conditions, in double
        EXPECT_LT(moment.norm(), 1e-11 * size);  // points lie up to 20 mm from the origin
        EXPECT_LT(solution.iterations, 100);
      }
    }
  }
}

TEST(RbfSolver, StartsFromWeightsThatAreRightAlready) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSolverSeed);
  const std::vector<Vec3> points_mm = test::random_points(500, kSolverSeed);
  const std::vector<double> values_mm = test::random_weights(500, kSolverSeed + 1);
  RbfSolver solver(RadialKernel::biharmonic, points_mm);
  const RbfSolution first = solver.solve(values_mm, 1e-6);
  EXPECT_GT(first.iterations, 0);
  const RbfSolution again = solver.solve(values_mm, 2e-6, first.model.weights);
  EXPECT_EQ(again.iterations, 0);
  // Projected once more, they round by 1e-15.
  for (std::size_t i = 0; i < 500; ++i) EXPECT_NEAR(again.model.weights[i], first.model.weights[i], 1e-12);
}

TEST(RbfSolver, SolvesForOtherValuesAsIfTheyWereTheFirst) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSolverSeed);
  const std::vector<Vec3> points_mm = test::random_points(400, kSolverSeed);
  const std::vector<double> values_mm = test::random_weights(400, kSolverSeed + 1);
  RbfSolver used(RadialKernel::biharmonic, points_mm);
  used.solve(test::random_weights(400, kSolverSeed + 2), 1e-2);
  const RbfModel second = used.solve(values_mm, 1e-6).model;
  const RbfModel first = RbfSolver(RadialKernel::biharmonic, points_mm).solve(values_mm, 1e-6).model;
  for (std::uint64_t n = 0; n < 50; ++n) {
    const Vec3 p = test::random_place(kSolverSeed + 3, n);
    // Both meet the values to 1e-6; between points the difference is of the same size.
    EXPECT_NEAR(test::plain_value(second, p), test::plain_value(first, p), 1e-5);
  }
}

TEST(RbfSolver, NeedsNoStepForValuesOfItsPolynomial) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSolverSeed);
  for (const RadialKernel kernel : kKernels) {
    const std::vector<Vec3> points_mm = test::random_points(polynomial_terms(kernel), kSolverSeed);
    std::vector<double> values_mm;
    values_mm.reserve(points_mm.size());
    for (const Vec3& p : points_mm) values_mm.push_back(1.0 + p.x() - 2.0 * p.z());
    const RbfSolution solution = RbfSolver(kernel, points_mm).solve(values_mm, 1e-9);
    EXPECT_EQ(solution.iterations, 0);
    for (std::uint64_t n = 0; n < 20; ++n) {
      const Vec3 p = test::random_place(kSolverSeed + 1, n);
      // Ten points at random determine a quadric to a few hundred roundings.
      EXPECT_NEAR(test::plain_value(solution.model, p), 1.0 + p.x() - 2.0 * p.z(), 1e-10);
    }
  }
}

TEST(RbfSolver, GivesTheSameBitsAtAnyNumberOfThreadsAndEachTime) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSolverSeed);
  const std::vector<Vec3> points_mm = test::clustered_points(1200, kSolverSeed);
  std::vector<double> values_mm;
  values_mm.reserve(points_mm.size());
  for (const Vec3& p : points_mm) values_mm.push_back(std::sin(p.x()) + 0.1 * p.y() * p.z());
  const auto solve = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return RbfSolver(RadialKernel::biharmonic, points_mm).solve(values_mm, 1e-4).model;
  };
  const RbfModel one = solve(1);
  for (const RbfModel& other : {solve(2), solve(2)}) {
    EXPECT_EQ(other.weights, one.weights);
    EXPECT_EQ(other.polynomial, one.polynomial);
  }
}

TEST(RbfSolver, SaysWhatItReachedWhenTheAccuracyIsOutOfReach) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSolverSeed);
  const std::vector<Vec3> points_mm = test::random_points(100, kSolverSeed);
  const std::vector<double> values_mm = test::random_weights(100, kSolverSeed + 1);
  EXPECT_THAT(test::error_of([&] { RbfSolver(RadialKernel::biharmonic, points_mm).solve(values_mm, 1e-25); }),
              testing::HasSubstr("expected to reach 1e-25 mm at all 100 points, reached"));
}

TEST(RbfSolver, StopsWhenItIsCancelled) {
  const Progress progress([](std::string_view, double) {});
  progress.cancel();
  RbfSolver solver(RadialKernel::biharmonic, test::random_points(100, kSolverSeed));
  EXPECT_THROW(solver.solve(test::random_weights(100, kSolverSeed), 1e-3, {}, progress), Cancelled);
}

}  // namespace
}  // namespace spinaltap::detail
