// Smoothing and low-pass filtering.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "core/rbf/fit_rbf.h"
#include "core/rbf/rbf_field.h"
#include "tests/unit/core/rbf/kernels.h"
#include "tests/unit/core/rbf/plain_sum.h"
#include "tests/unit/core/rbf/point_sets.h"

namespace spinaltap {
namespace {

using test::kKernels;

constexpr std::uint64_t kSmoothingSeed = 271;

/// A smooth function with noise of 0.2 mm at random points.
RbfValues noisy_values(std::size_t count) {
  RbfValues data{test::random_points(count, kSmoothingSeed), {}, {}};
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3& p = data.points_mm[i];
    data.values_mm.push_back(std::sin(0.3 * p.x()) + 0.2 * p.y() * std::cos(0.25 * p.z()) +
                             0.2 * random_normal(kSmoothingSeed + 5, i));
  }
  return data;
}

TEST(FitRbfSmoothing, MissesEachValueBySmoothingTimesItsWeight) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSmoothingSeed);
  const RbfValues data = noisy_values(400);
  for (const RadialKernel kernel : kKernels) {
    const double sign = kernel == RadialKernel::biharmonic ? 1.0 : -1.0;
    for (const double smoothing_mm : {0.1, 5.0}) {
      constexpr double kAccuracyMm = 1e-5;
      const RbfFit fit = fit_rbf(data, {.kernel = kernel, .accuracy_mm = kAccuracyMm, .smoothing_mm = smoothing_mm});
      for (std::size_t i = 0; i < 400; ++i) {
        const double missed_mm = test::plain_value(fit.model, data.points_mm[i]) - data.values_mm[i];
        EXPECT_NEAR(missed_mm, sign * smoothing_mm * fit.model.weights[i], kAccuracyMm);
      }
    }
  }
}

TEST(FitRbfSmoothing, MissesTheDataByMoreAndBendsLessTheMoreThereIs) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSmoothingSeed);
  const RbfValues data = noisy_values(300);
  for (const RadialKernel kernel : kKernels) {
    double last_residual = 0.0;
    double last_roughness = std::numeric_limits<double>::infinity();
    for (const double smoothing_mm : {0.0, 0.3, 3.0, 30.0, 300.0}) {
      const RbfModel model = fit_rbf(data, {.kernel = kernel, .accuracy_mm = 1e-4, .smoothing_mm = smoothing_mm}).model;
      double residual = 0.0;
      double roughness = 0.0;  // w'Aw with the sign that makes it positive: the norm that the fit weighs
      for (std::size_t i = 0; i < 300; ++i) {
        const Vec3& p = data.points_mm[i];
        residual += std::pow(test::plain_value(model, p) - data.values_mm[i], 2);
        roughness += (kernel == RadialKernel::biharmonic ? -1.0 : 1.0) * model.weights[i] *
                     test::plain_sum(kernel, 0.0, model.centres_mm, model.weights, p).value;
      }
      if (smoothing_mm > 0.0) {
        EXPECT_GT(residual, last_residual) << smoothing_mm;
      }
      EXPECT_LT(roughness, last_roughness) << smoothing_mm;
      EXPECT_GT(roughness, 0.0);
      last_residual = residual;
      last_roughness = roughness;
    }
  }
}

TEST(FitRbfSmoothing, TendsToTheLinearLeastSquaresFitWithoutEnd) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSmoothingSeed);
  const RbfValues data = noisy_values(100);
  Eigen::MatrixXd linear(100, 4);
  Eigen::VectorXd right(100);
  for (Eigen::Index i = 0; i < 100; ++i) {
    linear.row(i) << 1.0, data.points_mm[static_cast<std::size_t>(i)].transpose();
    right[i] = data.values_mm[static_cast<std::size_t>(i)];
  }
  const Eigen::Matrix4d normal = linear.transpose() * linear;
  const Eigen::Vector4d fit = normal.inverse() * (linear.transpose() * right);
  const RbfModel model = fit_rbf(data, {.accuracy_mm = 1e-6, .smoothing_mm = 1e8}).model;
  // The rest falls with 1 / smoothing: 1e3 (sums of distances) / 1e8.
  for (const Vec3& p : data.points_mm) EXPECT_NEAR(test::plain_value(model, p), fit[0] + fit.tail(3).dot(p), 1e-4);
}

/// phi convolved with 15 c^4 / (8 pi) (r^2 + c^2)^(-7/2), at distance r from its centre. Around the place x the kernel
/// is even in all directions, so that phi is first averaged over the sphere of radius t around x: for |y| that is
/// max(r, t) + min(r, t)^2 / (3 max(r, t)).
double convolved(double r, double c) {
  // t = c tan(a); Simpson's rule.
  constexpr int kSteps = 20000;
  const double end = 0.5 * std::numbers::pi;
  double sum = 0.0;
  for (int k = 0; k < kSteps; ++k) {  // the last place is infinitely far, where the integrand vanishes
    const double angle = end * k / kSteps;
    const double t = c * std::tan(angle);
    const double large = std::max(r, t);
    const double small = std::min(r, t);
    const double average = large > 0.0 ? large + small * small / (3.0 * large) : 0.0;
    const double kernel = 15.0 * std::pow(c, 4) / (8.0 * std::numbers::pi) * std::pow(t * t + c * c, -3.5);
    const double shell = 4.0 * std::numbers::pi * t * t * kernel * c / std::pow(std::cos(angle), 2);
    sum += (k == 0 ? 1.0 : k % 2 == 1 ? 4.0 : 2.0) * shell * average;
  }
  return sum * end / kSteps / 3.0;
}

TEST(LowPass, IsTheConvolutionOfTheFieldWithItsKernel) {
  for (const double width_mm : {0.3, 2.0}) {
    RbfModel model;
    model.low_pass_mm = width_mm;
    model.centres_mm = {Vec3(1, 2, 3)};
    model.weights = {2.5};
    model.polynomial = {0.0, 0.0, 0.0, 0.0};
    const RbfField field(model);
    for (const double r : {0.0, 0.1, 1.0, 7.0}) {
      const Vec3 p = Vec3(1, 2, 3) + r * Vec3(2, -1, 2) / 3.0;
      double value = 0.0;
      field.evaluate({&p, 1}, {&value, 1}, {});
      // Simpson's error: the fourth power of a step of 8e-5, but at the kink of the average, where it is the third.
      EXPECT_NEAR(value, 2.5 * convolved(r, width_mm), 1e-7) << "width " << width_mm << " r " << r;
    }
  }
}

TEST(LowPass, TendsToTheFieldAsItsWidthVanishes) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSmoothingSeed);
  for (const RadialKernel kernel : kKernels) {
    RbfModel model = fit_rbf(noisy_values(200), {.kernel = kernel}).model;
    const RbfField plain(model);
    const std::vector<Vec3> places_mm = test::random_points(100, kSmoothingSeed + 1);
    std::vector<double> expected(100);
    std::vector<double> found(100);
    plain.evaluate(places_mm, expected, {});
    double last = std::numeric_limits<double>::infinity();
    for (const double width_mm : {1.0, 0.1, 0.01, 0.001}) {
      model.low_pass_mm = width_mm;
      RbfField(model).evaluate(places_mm, found, {});
      double worst = 0.0;
      for (std::size_t i = 0; i < 100; ++i) worst = std::max(worst, std::abs(found[i] - expected[i]));
      // sqrt(r^2 + c^2) - r is c^2 / (2 r), so a hundredth for each tenth, but where a centre is nearer than c.
      EXPECT_LT(worst, last / 20.0) << width_mm;
      last = worst;
    }
    EXPECT_LT(last, 1e-4);
  }
}

}  // namespace
}  // namespace spinaltap
