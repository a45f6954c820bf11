// Compiled with optimisation: long loops of its own.

#include "core/rbf/reduce_centres.h"

#include <gtest/gtest.h>

#include <set>

#include "core/rbf/fit_rbf.h"
#include "core/rbf/merge_points.h"
#include "tests/support/test_kind.h"
#include "tests/unit/core/rbf/plain_sum.h"
#include "tests/unit/core/rbf/point_sets.h"
#include "tests/unit/core/rbf/vertebra_points.h"

namespace spinaltap {
namespace {

constexpr std::uint64_t kReductionSeed = 131;

/// The vertebra with every place once.
RbfValues vertebra() {
  const RbfValues all = test::vertebra_values(6.0);
  const std::vector<std::uint32_t> stands_for = detail::merge_points(all.points_mm, 1e-3);
  RbfValues data;
  for (std::size_t i = 0; i < stands_for.size(); ++i) {
    if (stands_for[i] != i) continue;
    data.points_mm.push_back(all.points_mm[i]);
    data.values_mm.push_back(all.values_mm[i]);
  }
  return data;
}

RbfValues ball_values(std::size_t count) {
  RbfValues data;
  for (const double radius_mm : {9.0, 10.0, 11.0}) {
    for (const Vec3& p : test::ball_points(count, radius_mm)) {
      data.points_mm.push_back(p);
      data.values_mm.push_back(radius_mm - 10.0);
    }
  }
  return data;
}

std::vector<double> differences(const RbfModel& model, const RbfValues& data) {
  std::vector<double> result;
  for (std::size_t i = 0; i < data.points_mm.size(); ++i) {
    result.push_back(std::abs(test::plain_value(model, data.points_mm[i]) - data.values_mm[i]));
  }
  return result;
}

double largest(const std::vector<double>& numbers) { return *std::max_element(numbers.begin(), numbers.end()); }

SLOW_TESTS("ReduceCentres.KeepsEveryPointWithinTheToleranceWithFewerCentres");

TEST(ReduceCentres, KeepsEveryPointWithinTheToleranceWithFewerCentres) {
  for (const RbfValues& data : {ball_values(700), vertebra()}) {
    std::size_t last = data.points_mm.size();
    for (const double tolerance_mm : {0.05, 0.3}) {
      const detail::ReducedFit fit = detail::reduce_centres(RadialKernel::biharmonic, data.points_mm, data.values_mm,
                                                            tolerance_mm, 0.1 * tolerance_mm, {});
      EXPECT_LE(largest(differences(fit.model, data)), tolerance_mm);
      EXPECT_LT(fit.centres.size(), last);
      last = fit.centres.size();
      EXPECT_GT(fit.rounds, 1);
    }
  }
}

TEST(ReduceCentres, TakesItsCentresFromThePointsOnceEach) {
  const RbfValues data = vertebra();
  const detail::ReducedFit fit =
      detail::reduce_centres(RadialKernel::biharmonic, data.points_mm, data.values_mm, 0.2, 0.02, {});
  ASSERT_EQ(fit.centres.size(), fit.model.centres_mm.size());
  EXPECT_EQ(std::set<std::uint32_t>(fit.centres.begin(), fit.centres.end()).size(), fit.centres.size());
  for (std::size_t k = 0; k < fit.centres.size(); ++k) {
    EXPECT_EQ(fit.model.centres_mm[k], data.points_mm[fit.centres[k]]);
    EXPECT_LE(std::abs(test::plain_value(fit.model, fit.model.centres_mm[k]) - data.values_mm[fit.centres[k]]), 0.02);
  }
}

TEST(ReduceCentres, TakesTheTriharmonicKernel) {
  SCOPED_TRACE(::testing::Message() << "seed " << kReductionSeed);
  RbfValues data{test::random_points(800, kReductionSeed), {}, {}};
  for (const Vec3& p : data.points_mm) data.values_mm.push_back(std::sin(0.3 * p.x()) + 0.2 * std::cos(0.3 * p.z()));
  const detail::ReducedFit fit =
      detail::reduce_centres(RadialKernel::triharmonic, data.points_mm, data.values_mm, 0.02, 0.002, {});
  EXPECT_LE(largest(differences(fit.model, data)), 0.02);
  EXPECT_LT(fit.centres.size(), 400U);  // waves of 20 mm in a cube of 20 mm are soon met
}

TEST(ReduceCentres, EndsWithAllPointsWhenTheyAreNoise) {
  SCOPED_TRACE(::testing::Message() << "seed " << kReductionSeed);
  RbfValues data{test::random_points(300, kReductionSeed), test::random_weights(300, kReductionSeed + 1), {}};
  const detail::ReducedFit fit =
      detail::reduce_centres(RadialKernel::biharmonic, data.points_mm, data.values_mm, 1e-3, 1e-4, {});
  EXPECT_GT(fit.centres.size(), 290U);
  EXPECT_LE(largest(differences(fit.model, data)), 1e-3);
}

TEST(FitRbfReduction, ReportsWhatItsModelHas) {
  const RbfValues data = vertebra();
  for (const std::size_t slabs : {1U, 4U}) {
    const RbfFit fit = fit_rbf(data, {.reduction_mm = 0.2, .slabs = slabs});
    EXPECT_EQ(fit.report.centres, fit.model.centres_mm.size());
    EXPECT_LT(fit.report.centres, data.points_mm.size());
    const std::vector<double> found_mm = differences(fit.model, data);
    double mean_mm = 0.0;
    for (const double d : found_mm) mean_mm += d / static_cast<double>(found_mm.size());
    // The report's sums are good to a tenth of the accuracy of 0.01 mm, and more than twice that away from its samples.
    EXPECT_NEAR(fit.report.max_residual_mm, largest(found_mm), 2.5e-3) << slabs;
    EXPECT_NEAR(fit.report.mean_residual_mm, mean_mm, 1e-3) << slabs;
    if (slabs == 1) {
      EXPECT_LE(largest(found_mm), 0.2);
    }
  }
}

TEST(FitRbfReduction, KeepsWithinTheToleranceOfTheSmoothFit) {
  const RbfValues data = ball_values(500);
  const FitOptions smooth{.accuracy_mm = 1e-3, .smoothing_mm = 0.5};
  FitOptions both = smooth;
  both.reduction_mm = 0.05;
  const RbfModel all = fit_rbf(data, smooth).model;
  const RbfFit few = fit_rbf(data, both);
  EXPECT_LT(few.report.centres, data.points_mm.size());
  for (const Vec3& p : data.points_mm) {
    // The smooth fit's values are read with 1e-3 mm, and other runs may differ by as much.
    EXPECT_NEAR(test::plain_value(few.model, p), test::plain_value(all, p), 0.05 + 3e-3);
  }
}

TEST(ReduceCentresInSlabs, FitsTheCentresOfAllSlabs) {
  const RbfValues data = vertebra();
  const detail::ReducedFit fit =
      detail::reduce_centres_in_slabs(RadialKernel::biharmonic, data.points_mm, data.values_mm, 4, 0.2, 0.02, {});
  EXPECT_EQ(std::set<std::uint32_t>(fit.centres.begin(), fit.centres.end()).size(), fit.centres.size());
  EXPECT_LT(fit.centres.size(), data.points_mm.size());
  for (std::size_t k = 0; k < fit.centres.size(); ++k) {
    EXPECT_EQ(fit.model.centres_mm[k], data.points_mm[fit.centres[k]]);
    EXPECT_LE(std::abs(test::plain_value(fit.model, fit.model.centres_mm[k]) - data.values_mm[fit.centres[k]]), 0.02);
  }
}

}  // namespace
}  // namespace spinaltap
