#include "core/rbf/fit_surface.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/base/error.h"
#include "tests/support/error_of.h"
#include "tests/unit/core/rbf/point_sets.h"
#include "tests/unit/core/rbf/vertebra_points.h"

namespace spinaltap {
namespace {

using test::error_of;
using testing::HasSubstr;

const Vec3 kCentre(30.0, -200.0, 900.0);

SurfacePoints ball_surface(double radius_mm, std::size_t count) {
  SurfacePoints surface;
  for (const Vec3& p : test::ball_points(count, 1.0)) {
    surface.positions_mm.emplace_back(kCentre + radius_mm * p);
    surface.normals.push_back(p);
  }
  return surface;
}

SurfacePoints torus(double large_mm, double small_mm, int around, int across) {
  SurfacePoints surface;
  for (int i = 0; i < around; ++i) {
    const double u = 2.0 * std::numbers::pi * i / around;
    for (int j = 0; j < across; ++j) {
      const double v = 2.0 * std::numbers::pi * (j + 0.5 * (i % 2)) / across;
      const Vec3 out(std::cos(u), std::sin(u), 0.0);
      const Vec3 normal = std::cos(v) * out + std::sin(v) * Vec3::UnitZ();
      surface.positions_mm.emplace_back(kCentre + large_mm * out + small_mm * normal);
      surface.normals.push_back(normal);
    }
  }
  return surface;
}

double value_at(const RbfField& field, const Vec3& p) {
  double value = 0.0;
  field.evaluate({&p, 1}, {&value, 1}, {});
  return value;
}

/// Where the field is zero on the line from p along `normal`, by bisection within 0.3 mm, mm from p.
double zero_along(const RbfField& field, const Vec3& p, const Vec3& normal) {
  double inside = -0.3;
  double outside = 0.3;
  EXPECT_LT(value_at(field, p + inside * normal), 0.0);
  EXPECT_GT(value_at(field, p + outside * normal), 0.0);
  for (int halving = 0; halving < 30; ++halving) {
    const double middle = 0.5 * (inside + outside);
    (value_at(field, p + middle * normal) < 0.0 ? inside : outside) = middle;
  }
  return inside;
}

double worst_zero_mm(const RbfField& field, const SurfacePoints& others) {
  double worst_mm = 0.0;
  for (std::size_t i = 0; i < others.normals.size(); ++i) {
    worst_mm = std::max(worst_mm, std::abs(zero_along(field, others.positions_mm[i], others.normals[i])));
  }
  return worst_mm;
}

TEST(FitSurface, FollowsABallBetweenItsPoints) {
  const SurfaceFit fit = fit_surface(ball_surface(10.0, 1500));
  // Points 0.9 mm apart: the sagitta between them is 0.01 mm.
  EXPECT_LT(worst_zero_mm(fit.field, ball_surface(10.0, 151)), 0.02);
  EXPECT_LT(value_at(fit.field, kCentre), -2.0);
  EXPECT_GT(value_at(fit.field, kCentre + Vec3(15, 0, 0)), 2.0);
}

TEST(FitSurface, FollowsATorusAndKeepsItsHole) {
  const SurfaceFit fit = fit_surface(torus(9.0, 4.0, 64, 30));
  // Points 0.9 mm apart on a tube of 4 mm: a sagitta of 0.025 mm, most of which the normals take out.
  EXPECT_LT(worst_zero_mm(fit.field, torus(9.0, 4.0, 17, 11)), 0.02);
  EXPECT_GT(value_at(fit.field, kCentre), 0.5);
}

TEST(FitSurface, FollowsTheVertebra) {
  const SurfacePoints surface = test::vertebra_points(4.0);
  const SurfaceFit fit = fit_surface(surface);
  EXPECT_EQ(fit.report.points, surface.positions_mm.size());
  EXPECT_GT(fit.report.off_surface_points, surface.positions_mm.size());
  EXPECT_LT(fit.report.mean_residual_mm, 0.02);
  // Beyond the fillets, which are narrower than the points' spacing, the phantom's own field tells the ground truth.
  const Vertebra vertebra;
  std::vector<double> off_mm;
  for (std::size_t i = 0; i < surface.normals.size(); i += 7) {
    for (const double side_mm : {-0.5, 0.5}) {
      const Vec3 p = surface.positions_mm[i] + side_mm * surface.normals[i];
      double expected_mm = 0.0;
      vertebra.evaluate({&p, 1}, {&expected_mm, 1}, {});
      off_mm.push_back(std::abs(value_at(fit.field, p) - expected_mm));
    }
  }
  std::sort(off_mm.begin(), off_mm.end());
  EXPECT_LT(off_mm[off_mm.size() / 2], 0.05);
  EXPECT_LT(off_mm[off_mm.size() * 9 / 10], 0.2);
}

TEST(FitSurface, ReportsTheResidualsThatItsFieldHas) {
  constexpr std::uint64_t kSeed = 3;
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  SurfacePoints surface = ball_surface(10.0, 1000);
  for (std::size_t i = 0; i < 1000; ++i) surface.positions_mm[i] += 0.05 * random_normal(kSeed, i) * surface.normals[i];
  const SurfaceFit fit = fit_surface(surface, {.smoothing_mm = 1.0});
  std::vector<double> residual_mm(1000);
  fit.field.evaluate(surface.positions_mm, residual_mm, {});
  for (double& value : residual_mm) value = std::abs(value);
  std::sort(residual_mm.begin(), residual_mm.end());
  EXPECT_EQ(fit.report.points, 1000U);
  EXPECT_EQ(fit.report.max_residual_mm, residual_mm.back());
  EXPECT_NEAR(fit.report.mean_residual_mm, std::accumulate(residual_mm.begin(), residual_mm.end(), 0.0) / 1000.0,
              1e-14);
  EXPECT_EQ(fit.report.p99_residual_mm, residual_mm[989]);
  EXPECT_GT(fit.report.max_residual_mm, 0.05);
  EXPECT_EQ(fit.report.centres, 1000U + fit.report.off_surface_points);
  EXPECT_EQ(fit.field.centre_count(), fit.report.centres);
}

TEST(FitSurface, PassesThroughAllPointsWithoutSmoothing) {
  const SurfaceFit fit = fit_surface(ball_surface(10.0, 800), {.smoothing_mm = 0.0, .accuracy_mm = 1e-3});
  // The report's own sums add their error, 1e-3 mm at most.
  EXPECT_LT(fit.report.max_residual_mm, 2e-3);
}

TEST(FitSurface, PutsCentresWhereTheSurfaceIsMissedWhenItReduces) {
  // A ball with a bump of 1.5 mm: a few evenly spread centres miss it, those of later rounds lie on it.
  SurfacePoints surface = ball_surface(10.0, 2500);
  for (std::size_t i = 0; i < surface.normals.size(); ++i) {
    const double angle = std::acos(surface.normals[i].z());
    surface.positions_mm[i] += 1.5 * std::exp(-0.5 * std::pow(angle / 0.12, 2.0)) * surface.normals[i];
  }
  const SurfaceFit fit = fit_surface(surface, {.smoothing_mm = 0.0, .reduction_mm = 0.05});
  EXPECT_LE(fit.report.max_residual_mm, 0.05);
  EXPECT_LT(fit.report.centres, 2500U);
  std::size_t on_bump = 0;
  for (const Vec3& c : fit.field.model().centres_mm) {
    if ((c - kCentre).normalized().z() > std::cos(0.36)) ++on_bump;  // three widths: 3.2 % of the ball
  }
  EXPECT_GT(static_cast<double>(on_bump), 0.064 * static_cast<double>(fit.report.centres));
}

TEST(FitSurface, GivesTheSameBitsAtAnyNumberOfThreads) {
  const SurfacePoints surface = ball_surface(10.0, 900);
  const auto values = [&] {
    std::vector<double> found(900);
    fit_surface(surface).field.evaluate(surface.positions_mm, found, {});
    return found;
  };
  std::vector<double> one;
  {
    const tbb::global_control serial(tbb::global_control::max_allowed_parallelism, 1);
    one = values();
  }
  const tbb::global_control parallel(tbb::global_control::max_allowed_parallelism, 2);
  EXPECT_EQ(values(), one);
}

TEST(FitSurface, TakesPointsGivenTwice) {
  SurfacePoints surface = ball_surface(10.0, 800);
  const SurfacePoints again = surface;
  surface.positions_mm.insert(surface.positions_mm.end(), again.positions_mm.begin(), again.positions_mm.end());
  surface.normals.insert(surface.normals.end(), again.normals.begin(), again.normals.end());
  const SurfaceFit fit = fit_surface(surface);
  EXPECT_LE(fit.report.centres, 3U * 800U);
  EXPECT_LT(fit.report.max_residual_mm, 0.05);
}

TEST(FitSurface, ShortensOffSurfaceDistancesWhereAnotherPartIsNear) {
  // Two balls 0.6 mm apart: off-surface points of 1 mm would lie in the other ball and melt the two together.
  SurfacePoints surface = ball_surface(5.0, 700);
  const SurfacePoints other = surface;
  const Vec3 shift_mm(10.6, 0.0, 0.0);
  for (std::size_t i = 0; i < 700; ++i) {
    surface.positions_mm.emplace_back(other.positions_mm[i] + shift_mm);
    surface.normals.push_back(other.normals[i]);
  }
  const SurfaceFit fit = fit_surface(surface);
  EXPECT_GT(value_at(fit.field, kCentre + 0.5 * shift_mm), 0.1);
  EXPECT_LT(value_at(fit.field, kCentre), -1.0);
  EXPECT_LT(value_at(fit.field, kCentre + shift_mm), -1.0);
}

TEST(FitSurface, RejectsPointsAndOptionsWithoutSense) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const SurfacePoints good = ball_surface(10.0, 200);
  const auto error = [](const SurfacePoints& surface, const SurfaceFitOptions& options = {}) {
    return error_of([&] { fit_surface(surface, options); });
  };
  EXPECT_EQ(error(good), "");
  EXPECT_THAT(error(ball_surface(10.0, 19)), HasSubstr("found 19"));
  SurfacePoints bad = good;
  bad.normals.pop_back();
  EXPECT_THAT(error(bad), HasSubstr("RBF"));
  bad = good;
  bad.positions_mm[5].x() = nan;
  EXPECT_THAT(error(bad), HasSubstr("not a number"));
  bad = good;
  bad.normals[5].z() = nan;
  EXPECT_THAT(error(bad), HasSubstr("not a number"));
  bad = good;
  for (Vec3& normal : bad.normals) normal.setZero();
  EXPECT_THAT(error(bad), HasSubstr("unit normals"));
  EXPECT_THAT(error(good, {.spacing_mm = -1.0}), HasSubstr("spacing"));
  EXPECT_THAT(error(good, {.spacing_mm = nan}), HasSubstr("spacing"));
  EXPECT_THAT(error(good, {.off_surface_mm = 0.0}), HasSubstr("off-surface"));
  EXPECT_THAT(error(good, {.off_surface_mm = nan}), HasSubstr("off-surface"));
  EXPECT_THAT(error(good, {.smoothing_mm = -1.0}), HasSubstr("smoothing"));
  EXPECT_THAT(error(good, {.accuracy_mm = nan}), HasSubstr("accuracy"));
  EXPECT_THAT(error(good, {.reduction_mm = nan}), HasSubstr("reduction"));
}

TEST(FitSurface, ThinsOutDensePointsAndStillPassesTheRest) {
  // 6,000 points on a sphere of 10 mm lie 0.46 mm apart; every second or third is enough for so smooth a surface.
  const SurfacePoints surface = ball_surface(10.0, 6000);
  const SurfaceFit all = fit_surface(surface, {.spacing_mm = 0.0});
  const SurfaceFit some = fit_surface(surface, {.spacing_mm = 0.7});
  EXPECT_EQ(all.report.centres, 3 * surface.positions_mm.size());
  EXPECT_LT(some.report.centres, all.report.centres / 2);
  EXPECT_EQ(some.report.points, surface.positions_mm.size());
  EXPECT_LT(some.report.max_residual_mm, 0.02);
}

TEST(FitSurface, StopsWhenItIsCancelled) {
  const Progress progress([](std::string_view, double) {});
  progress.cancel();
  EXPECT_THROW(fit_surface(ball_surface(10.0, 200), {}, progress), Cancelled);
}

}  // namespace
}  // namespace spinaltap
