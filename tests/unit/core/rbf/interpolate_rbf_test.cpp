#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "core/base/random.h"
#include "core/rbf/rbf_fit.h"
#include "tests/unit/core/ct/error_of.h"

namespace spinaltap {
namespace {

using test::error_of;
using testing::HasSubstr;

constexpr std::uint64_t kSeed = 1729;

Vec3 random_point(std::uint64_t n, double reach_mm = 10.0, std::uint64_t seed = kSeed) {
  const auto coordinate = [&](std::uint64_t axis) {
    return reach_mm * (2.0 * random_uniform(seed, 3 * n + axis) - 1.0);
  };
  return {coordinate(0), coordinate(1), coordinate(2)};
}

std::vector<Vec3> random_points(std::size_t count) {
  std::vector<Vec3> points_mm;
  for (std::size_t i = 0; i < count; ++i) points_mm.push_back(random_point(i));
  return points_mm;
}

/// Something smooth that is not linear.
double wavy(const Vec3& p) { return std::sin(0.3 * p.x()) + 0.2 * p.y() * std::cos(0.25 * p.z()); }

template <class Function>
std::vector<double> values_of(const std::vector<Vec3>& points_mm, const Function& function) {
  std::vector<double> values;
  for (const Vec3& p : points_mm) values.push_back(function(p));
  return values;
}

double value_at(const RbfField& field, const Vec3& p) {
  double value = 0.0;
  field.evaluate({&p, 1}, {&value, 1}, {});
  return value;
}

TEST(InterpolateRbf, ReproducesLinearFunctionsEverywhere) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  const Vec3 slope(0.7, -1.3, 0.4);
  const auto linear = [&](const Vec3& p) { return 2.5 + slope.dot(p); };
  const std::vector<Vec3> points_mm = random_points(120);
  const RbfField field = interpolate_rbf(points_mm, values_of(points_mm, linear));
  for (std::uint64_t n = 0; n < 200; ++n) {
    const Vec3 p = random_point(n, 40.0, kSeed + 1);  // also far from the data
    double value = 0.0;
    Vec3 gradient;
    field.evaluate({&p, 1}, {&value, 1}, {&gradient, 1});
    EXPECT_NEAR(value, linear(p), 1e-10);
    EXPECT_LT((gradient - slope).norm(), 1e-11);
  }
}

TEST(InterpolateRbf, PassesThroughItsData) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  const std::vector<Vec3> points_mm = random_points(600);
  const std::vector<double> values = values_of(points_mm, wavy);
  const RbfField field = interpolate_rbf(points_mm, values);
  for (std::size_t i = 0; i < points_mm.size(); ++i) EXPECT_NEAR(value_at(field, points_mm[i]), values[i], 1e-9);
}

TEST(InterpolateRbf, ComesNearASmoothFunctionBetweenItsData) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  const std::vector<Vec3> points_mm = random_points(1000);
  const RbfField field = interpolate_rbf(points_mm, values_of(points_mm, wavy));
  double worst = 0.0;
  for (std::uint64_t n = 0; n < 300; ++n) {
    const Vec3 p = random_point(n, 8.0, kSeed + 2);
    worst = std::max(worst, std::abs(value_at(field, p) - wavy(p)));
  }
  // Points 2 mm apart against waves of 21 mm; the function spans +-3.
  EXPECT_LT(worst, 0.1);
}

TEST(InterpolateRbf, HasTheGradientThatDifferencesGive) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  const std::vector<Vec3> points_mm = random_points(200);
  const RbfField field = interpolate_rbf(points_mm, values_of(points_mm, wavy));
  for (std::uint64_t n = 0; n < 100; ++n) {
    const Vec3 p = random_point(n, 12.0, kSeed + 3);
    double value = 0.0;
    Vec3 gradient;
    field.evaluate({&p, 1}, {&value, 1}, {&gradient, 1});
    for (int axis = 0; axis < 3; ++axis) {
      constexpr double kStepMm = 1e-5;
      const Vec3 step = kStepMm * Vec3::Unit(axis);
      const double slope = (value_at(field, p + step) - value_at(field, p - step)) / (2.0 * kStepMm);
      // Rounding: 1e-14 of a sum of some hundreds over 2e-5 mm.
      EXPECT_NEAR(gradient[axis], slope, 1e-6);
    }
  }
}

TEST(InterpolateRbf, HasAGradientAtItsCentresToo) {
  const std::vector<Vec3> points_mm = random_points(50);
  const RbfField field = interpolate_rbf(points_mm, values_of(points_mm, wavy));
  std::vector<double> values(50);
  std::vector<Vec3> gradients(50);
  field.evaluate(points_mm, values, gradients);
  for (const Vec3& gradient : gradients) {
    EXPECT_TRUE(gradient.allFinite());
    EXPECT_LT(gradient.norm(), 10.0);
  }
}

TEST(InterpolateRbf, DoesNotCareHowItsDataAreTurnedAndShifted) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  const std::vector<Vec3> points_mm = random_points(300);
  const std::vector<double> values = values_of(points_mm, wavy);
  const Mat3 turn = Eigen::AngleAxisd(1.1, Vec3(2, -1, 3).normalized()).toRotationMatrix();
  const Vec3 shift_mm(-300.0, 800.0, 1200.0);
  std::vector<Vec3> moved_mm;
  for (const Vec3& p : points_mm) moved_mm.push_back(turn * p + shift_mm);
  const RbfField field = interpolate_rbf(points_mm, values);
  const RbfField moved = interpolate_rbf(moved_mm, values);
  for (std::uint64_t n = 0; n < 100; ++n) {
    const Vec3 p = random_point(n, 12.0, kSeed + 4);
    // Positions of 1,500 mm are held to 2e-13 mm.
    EXPECT_NEAR(value_at(moved, turn * p + shift_mm), value_at(field, p), 1e-9);
  }
}

TEST(InterpolateRbf, MissesItsDataByMoreAsItIsSmoothedMore) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  const std::vector<Vec3> points_mm = random_points(300);
  std::vector<double> values = values_of(points_mm, wavy);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] += 0.2 * random_normal(kSeed + 5, i);
  double last_residual = 0.0;
  double last_roughness = std::numeric_limits<double>::infinity();
  for (const double smoothing_mm : {0.0, 0.3, 3.0, 30.0, 300.0}) {
    const RbfField field = interpolate_rbf(points_mm, values, smoothing_mm);
    double residual = 0.0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      residual += std::pow(value_at(field, points_mm[i]) - values[i], 2.0);
    }
    // How much the gradient changes from place to place.
    double roughness = 0.0;
    for (std::uint64_t n = 0; n < 200; ++n) {
      const Vec3 p = random_point(n, 8.0, kSeed + 6);
      const std::vector<Vec3> pair{p, p + Vec3(0.5, 0.5, 0.5)};
      std::vector<double> ignored(2);
      std::vector<Vec3> gradients(2);
      field.evaluate(pair, ignored, gradients);
      roughness += (gradients[0] - gradients[1]).squaredNorm();
    }
    if (smoothing_mm > 0.0) {
      EXPECT_GT(residual, last_residual) << smoothing_mm;
    } else {
      EXPECT_LT(residual, 1e-15);
    }
    EXPECT_LT(roughness, last_roughness) << smoothing_mm;
    last_residual = residual;
    last_roughness = roughness;
  }
}

TEST(InterpolateRbf, TendsToTheLinearLeastSquaresFitWhenSmoothedWithoutEnd) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  const std::vector<Vec3> points_mm = random_points(100);
  const std::vector<double> values = values_of(points_mm, wavy);
  Eigen::MatrixXd linear(100, 4);
  Eigen::VectorXd right(100);
  for (Eigen::Index i = 0; i < 100; ++i) {
    linear.row(i) << 1.0, points_mm[static_cast<std::size_t>(i)].transpose();
    right[i] = values[static_cast<std::size_t>(i)];
  }
  const Eigen::VectorXd fit = linear.householderQr().solve(right);
  const RbfField field = interpolate_rbf(points_mm, values, 1e8);
  for (const Vec3& p : points_mm) EXPECT_NEAR(value_at(field, p), fit[0] + fit.tail(3).dot(p), 1e-4);
}

TEST(InterpolateRbf, SaysWhatIsWrongWithPointsThatMakeNoField) {
  const auto error = [](const std::vector<Vec3>& points_mm) {
    return error_of([&] { interpolate_rbf(points_mm, std::vector<double>(points_mm.size(), 1.0)); });
  };
  EXPECT_THAT(error({}), HasSubstr("expected 4 to 20000 points"));
  EXPECT_THAT(error({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}), HasSubstr("found 3"));
  EXPECT_THAT(error(std::vector<Vec3>(20'001)), HasSubstr("found 20001"));
  // A plane at an angle, a line and a heap, away from the origin.
  std::vector<Vec3> plane, line, heap;
  for (std::uint64_t n = 0; n < 50; ++n) {
    const Vec3 p = random_point(n);
    plane.push_back(Vec3(500, 600, 700) + p.x() * Vec3(1, 2, 3).normalized() + p.y() * Vec3(3, 0, -1).normalized());
    line.push_back(Vec3(500, 600, 700) + p.x() * Vec3(1, 2, 3).normalized());
    heap.push_back(Vec3(500, 600, 700));
  }
  EXPECT_THAT(error(plane), HasSubstr("lie in a plane"));
  EXPECT_THAT(error(line), HasSubstr("lie in a plane"));
  EXPECT_THAT(error(heap), HasSubstr("lie in a plane"));
  std::vector<Vec3> twice = random_points(50);
  twice.push_back(twice[7]);
  EXPECT_THAT(error(twice), HasSubstr("two points are the same"));
  std::vector<Vec3> broken = random_points(50);
  broken[3].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(error(broken), HasSubstr("point is not a number"));
}

TEST(InterpolateRbf, TakesTheSamePointTwiceWhenItIsSmoothed) {
  std::vector<Vec3> twice = random_points(50);
  twice.push_back(twice[7]);
  std::vector<double> values = values_of(twice, wavy);
  values.back() += 0.2;
  const RbfField field = interpolate_rbf(twice, values, 0.1);
  // Between what the two say.
  EXPECT_GT(value_at(field, twice[7]), values[7] - 0.2);
  EXPECT_LT(value_at(field, twice[7]), values.back() + 0.2);
}

TEST(InterpolateRbf, RefusesValuesAndSmoothingThatAreNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Vec3> points_mm = random_points(10);
  std::vector<double> values(10, 1.0);
  EXPECT_THROW(interpolate_rbf(points_mm, std::vector<double>(9)), Error);
  EXPECT_THROW(interpolate_rbf(points_mm, values, nan), Error);
  EXPECT_THROW(interpolate_rbf(points_mm, values, -1.0), Error);
  EXPECT_THROW(interpolate_rbf(points_mm, values, std::numeric_limits<double>::infinity()), Error);
  values[4] = nan;
  EXPECT_THAT(error_of([&] { interpolate_rbf(points_mm, values); }), HasSubstr("value is not a number"));
}

}  // namespace
}  // namespace spinaltap
