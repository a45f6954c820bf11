#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <numeric>

#include "core/base/error.h"
#include "core/base/random.h"
#include "core/rbf/rbf_fit.h"
#include "tests/unit/core/ct/error_of.h"

namespace spinaltap {
namespace {

using test::error_of;
using testing::HasSubstr;

const Vec3 kCentre(30.0, -200.0, 900.0);

/// Points spread evenly over a ball's surface by the golden angle.
SurfacePoints ball(double radius_mm, std::size_t count) {
  SurfacePoints surface;
  for (std::size_t i = 0; i < count; ++i) {
    const double z = 1.0 - 2.0 * (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    const double angle = std::numbers::pi * (3.0 - std::sqrt(5.0)) * static_cast<double>(i);
    const double off = std::sqrt(1.0 - z * z);
    const Vec3 normal(off * std::cos(angle), off * std::sin(angle), z);
    surface.positions_mm.push_back(kCentre + radius_mm * normal);
    surface.normals.push_back(normal);
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
      surface.positions_mm.push_back(kCentre + large_mm * out + small_mm * normal);
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
  double inside = -0.3, outside = 0.3;
  EXPECT_LT(value_at(field, p + inside * normal), 0.0);
  EXPECT_GT(value_at(field, p + outside * normal), 0.0);
  for (int halving = 0; halving < 30; ++halving) {
    const double middle = 0.5 * (inside + outside);
    (value_at(field, p + middle * normal) < 0.0 ? inside : outside) = middle;
  }
  return inside;
}

TEST(FitSurfaceRbf, FollowsABallBetweenItsPoints) {
  const RbfFit fit = fit_surface_rbf(ball(10.0, 3000), {.max_surface_centres = 1000, .tolerance_mm = 0.005});
  double worst_mm = 0.0;
  const SurfacePoints others = ball(10.0, 211);
  for (std::size_t i = 0; i < 211; ++i) {
    worst_mm = std::max(worst_mm, std::abs(zero_along(fit.field, others.positions_mm[i], others.normals[i])));
  }
  EXPECT_LT(worst_mm, 0.02);
  EXPECT_LT(value_at(fit.field, kCentre), -2.0);
  EXPECT_GT(value_at(fit.field, kCentre + Vec3(15, 0, 0)), 2.0);
}

TEST(FitSurfaceRbf, FollowsATorusAndKeepsItsHole) {
  const RbfFit fit = fit_surface_rbf(torus(9.0, 4.0, 90, 44), {.max_surface_centres = 1500, .tolerance_mm = 0.005});
  double worst_mm = 0.0;
  const SurfacePoints others = torus(9.0, 4.0, 17, 13);
  for (std::size_t i = 0; i < others.normals.size(); ++i) {
    worst_mm = std::max(worst_mm, std::abs(zero_along(fit.field, others.positions_mm[i], others.normals[i])));
  }
  EXPECT_LT(worst_mm, 0.02);
  EXPECT_GT(value_at(fit.field, kCentre), 0.5);
}

TEST(FitSurfaceRbf, ReportsTheResidualsThatItsFieldHas) {
  constexpr std::uint64_t kSeed = 3;
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  SurfacePoints surface = ball(10.0, 2000);
  for (std::size_t i = 0; i < 2000; ++i) surface.positions_mm[i] += 0.05 * random_normal(kSeed, i) * surface.normals[i];
  const RbfFit fit = fit_surface_rbf(surface, {.max_surface_centres = 300});
  std::vector<double> residual_mm(2000);
  fit.field.evaluate(surface.positions_mm, residual_mm, {});
  for (double& value : residual_mm) value = std::abs(value);
  std::sort(residual_mm.begin(), residual_mm.end());
  EXPECT_EQ(fit.report.points, 2000U);
  EXPECT_EQ(fit.report.max_residual_mm, residual_mm.back());
  EXPECT_NEAR(fit.report.mean_residual_mm, std::accumulate(residual_mm.begin(), residual_mm.end(), 0.0) / 2000.0,
              1e-14);
  EXPECT_EQ(fit.report.p99_residual_mm, residual_mm[1979]);
  EXPECT_GT(fit.report.max_residual_mm, 0.05);
  EXPECT_LE(fit.report.surface_centres, 300U);
  EXPECT_EQ(fit.field.centre_count(), fit.report.surface_centres + fit.report.off_surface_centres);
}

TEST(FitSurfaceRbf, PutsLaterCentresWhereTheSurfaceIsMissed) {
  // A ball with a bump of 1.5 mm: a few evenly spread centres miss it, those of later rounds lie on it.
  SurfacePoints surface = ball(10.0, 4000);
  for (std::size_t i = 0; i < surface.normals.size(); ++i) {
    const double angle = std::acos(surface.normals[i].z());
    surface.positions_mm[i] += 1.5 * std::exp(-0.5 * std::pow(angle / 0.12, 2.0)) * surface.normals[i];
  }
  const RbfFit fit = fit_surface_rbf(surface, {.max_surface_centres = 400});
  EXPECT_GT(fit.report.rounds, 1);
  EXPECT_LT(fit.report.max_residual_mm, 0.1);
  EXPECT_LT(fit.report.mean_residual_mm, 0.04);
}

TEST(FitSurfaceRbf, CoversPointsOnALatticeEvenly) {
  // On a lattice the size of a spread subset jumps; whatever subset is taken must reach every part of the surface.
  SurfacePoints surface;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      for (int u = -9; u <= 9; ++u) {
        for (int v = -9; v <= 9; ++v) {
          Vec3 p;
          p[axis] = 10.0 * side;
          p[(axis + 1) % 3] = u;
          p[(axis + 2) % 3] = v;
          surface.positions_mm.push_back(kCentre + p);
          surface.normals.push_back(side * Vec3::Unit(axis));
        }
      }
    }
  }
  const RbfFit fit = fit_surface_rbf(surface, {.max_surface_centres = 400, .tolerance_mm = 10.0});
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      const Vec3 p = kCentre + 10.0 * side * Vec3::Unit(axis);
      // Centres 2 mm apart on flat faces: near the middle of a face the surface is right.
      EXPECT_NEAR(value_at(fit.field, p), 0.0, 0.1) << axis << " " << side;
    }
  }
}

TEST(FitSurfaceRbf, GivesTheSameBitsAtAnyNumberOfThreads) {
  const SurfacePoints surface = ball(10.0, 1500);
  const auto values = [&] {
    const RbfFit fit = fit_surface_rbf(surface, {.max_surface_centres = 250});
    std::vector<double> found(1500);
    fit.field.evaluate(surface.positions_mm, found, {});
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

TEST(FitSurfaceRbf, TakesPointsGivenTwice) {
  SurfacePoints surface = ball(10.0, 800);
  const SurfacePoints again = surface;
  surface.positions_mm.insert(surface.positions_mm.end(), again.positions_mm.begin(), again.positions_mm.end());
  surface.normals.insert(surface.normals.end(), again.normals.begin(), again.normals.end());
  const RbfFit fit = fit_surface_rbf(surface, {.max_surface_centres = 1900});
  EXPECT_LE(fit.report.surface_centres, 800U);
  EXPECT_LT(fit.report.max_residual_mm, 0.05);
}

TEST(FitSurfaceRbf, ShortensOffSurfaceDistancesWhereAnotherPartIsNear) {
  // Two balls 0.6 mm apart: off-surface points of 1 mm would lie in the other ball and melt the two together.
  SurfacePoints surface = ball(5.0, 1500);
  const SurfacePoints other = ball(5.0, 1500);
  const Vec3 shift_mm(10.6, 0.0, 0.0);
  for (std::size_t i = 0; i < 1500; ++i) {
    surface.positions_mm.push_back(other.positions_mm[i] + shift_mm);
    surface.normals.push_back(other.normals[i]);
  }
  const RbfFit fit = fit_surface_rbf(surface, {.max_surface_centres = 800});
  EXPECT_GT(value_at(fit.field, kCentre + 0.5 * shift_mm), 0.1);
  EXPECT_LT(value_at(fit.field, kCentre), -1.0);
  EXPECT_LT(value_at(fit.field, kCentre + shift_mm), -1.0);
}

TEST(FitSurfaceRbf, RefusesPointsAndOptionsWithoutSense) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const SurfacePoints good = ball(10.0, 200);
  const auto error = [](const SurfacePoints& surface, const RbfFitOptions& options = {}) {
    return error_of([&] { fit_surface_rbf(surface, options); });
  };
  EXPECT_EQ(error(good), "");
  EXPECT_THAT(error(ball(10.0, 19)), HasSubstr("found 19"));
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
  EXPECT_THAT(error(good, {.tolerance_mm = nan}), HasSubstr("tolerance"));
  EXPECT_THAT(error(good, {.off_surface_mm = 0.0}), HasSubstr("off-surface"));
  EXPECT_THAT(error(good, {.smoothing_mm = -1.0}), HasSubstr("smoothing"));
}

TEST(FitSurfaceRbf, StopsWhenItIsCancelled) {
  const Progress progress([](std::string_view, double) {});
  progress.cancel();
  EXPECT_THROW(fit_surface_rbf(ball(10.0, 200), {}, progress), Cancelled);
}

}  // namespace
}  // namespace spinaltap
