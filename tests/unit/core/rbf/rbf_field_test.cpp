// Compiled with optimisation: long loops of its own.

#include "core/rbf/rbf_field.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <limits>

#include "core/rbf/detail/fast_sum.h"
#include "core/rbf/detail/polynomial.h"
#include "tests/support/error_of.h"
#include "tests/support/test_kind.h"
#include "tests/unit/core/rbf/plain_sum.h"
#include "tests/unit/core/rbf/point_sets.h"

namespace spinaltap {
namespace {

constexpr std::uint64_t kFieldSeed = 163;

/// Small weights of both signs that sum to nothing, as those of a fit; 2,000 centres are summed term by term.
RbfModel model_of(std::size_t count, RadialKernel kernel = RadialKernel::biharmonic) {
  RbfModel model;
  model.kernel = kernel;
  model.centres_mm = test::ball_points(count);
  for (std::size_t i = 0; i < count; ++i) {
    model.weights.push_back((i % 2 == 0 ? 1.0 : -1.0) * (0.01 + 1e-3 * random_uniform(kFieldSeed, i / 2)));
  }
  model.origin_mm = Vec3(1, 2, 3);
  model.polynomial.assign(polynomial_terms(kernel), 0.1);
  return model;
}

SLOW_TESTS("RbfField.IsWithinItsAccuracyOfTheSumTermByTerm");

TEST(RbfField, IsTheSumThatItsWeightsSay) {
  RbfModel model;
  model.centres_mm = {Vec3(1, 0, 0), Vec3(0, 3, 0)};
  model.weights = {2.0, -0.5};
  model.polynomial = {1.0, 0.1, 0.2, 0.3};
  model.origin_mm = Vec3(10, 10, 10);
  const RbfField field(model);
  EXPECT_EQ(field.centre_count(), 2U);
  const Vec3 p(1, 3, 4);
  double value = 0.0;
  Vec3 gradient;
  field.evaluate({&p, 1}, {&value, 1}, {&gradient, 1});
  // |p - c1| = 5, |p - c2| = sqrt(17), p - origin = (-9, -7, -6).
  EXPECT_NEAR(value, 2.0 * 5.0 - 0.5 * std::sqrt(17.0) + 1.0 - 0.9 - 1.4 - 1.8, 1e-14);
  const Vec3 expected = 2.0 * Vec3(0, 3, 4) / 5.0 - 0.5 * Vec3(1, 0, 4) / std::sqrt(17.0) + Vec3(0.1, 0.2, 0.3);
  EXPECT_LT((gradient - expected).norm(), 1e-14);
  // A centre's own term has no gradient there.
  field.evaluate({&model.centres_mm[0], 1}, {&value, 1}, {&gradient, 1});
  EXPECT_LT((gradient - (-0.5 * Vec3(1, -3, 0) / std::sqrt(10.0) + Vec3(0.1, 0.2, 0.3))).norm(), 1e-14);
}

TEST(RbfField, MayBeAPolynomialAlone) {
  RbfModel model;
  model.polynomial = {1.0, 0.1, 0.2, 0.3};
  const Vec3 p(1, 3, 4);
  double value = 0.0;
  RbfField(model).evaluate({&p, 1}, {&value, 1}, {});
  EXPECT_NEAR(value, 1.0 + 0.1 + 0.6 + 1.2, 1e-15);
}

TEST(RbfField, IsWithinItsAccuracyOfTheSumTermByTerm) {
  SCOPED_TRACE(::testing::Message() << "seed " << kFieldSeed);
  for (const RadialKernel kernel : {RadialKernel::biharmonic, RadialKernel::triharmonic}) {
    for (const double width_mm : {0.0, 0.5}) {
      for (const std::size_t count : {2000U, 2400U}) {
        for (const double accuracy_mm : {1e-2, 1e-5}) {
          RbfModel model = model_of(count, kernel);
          model.low_pass_mm = width_mm;
          const RbfField field(model, accuracy_mm);
          EXPECT_LE(field.value_error_mm(), accuracy_mm);
          EXPECT_LE(field.gradient_error(), accuracy_mm);
          if (count == 2000) {
            EXPECT_EQ(field.value_error_mm(), 0.0);
          }
          std::vector<Vec3> places_mm;
          for (std::uint64_t n = 0; n < 200; ++n) places_mm.push_back(test::random_place(kFieldSeed + 1, n, 12.0));
          for (std::size_t i = 0; i < 200; ++i) {
            places_mm.emplace_back(model.centres_mm[10 * i] + test::random_place(kFieldSeed + 2, i, 0.2));
          }
          std::vector<double> values(400);
          std::vector<Vec3> gradients(400);
          field.evaluate(places_mm, values, gradients);
          double worst = 0.0;
          double worst_near = 0.0;  // beside centres
          for (std::size_t i = 0; i < 400; ++i) {
            const auto sum = test::plain_sum(kernel, width_mm, model.centres_mm, model.weights, places_mm[i]);
            const double error = std::abs(values[i] - sum.value - test::plain_polynomial(model, places_mm[i]));
            worst = std::max(worst, error);
            if (i >= 200) worst_near = std::max(worst_near, error);
            Vec3 slope = sum.gradient + Vec3::Constant(0.1);
            if (kernel == RadialKernel::triharmonic) {
              const Vec3 d = places_mm[i] - model.origin_mm;
              slope += 0.1 * (Vec3::Constant(d.sum()) + d);
            }
            EXPECT_LT((gradients[i] - slope).norm(), accuracy_mm);
          }
          EXPECT_LT(worst, accuracy_mm);
          // Honest: such places are hardly worse than those that were looked at, the worst of 512.
          EXPECT_LE(worst_near, 2.5 * field.value_error_mm() + 1e-10);
        }
      }
    }
  }
}

TEST(RbfField, IsAsAccurateFarFromItsCentresAsBesideThem) {
  SCOPED_TRACE(::testing::Message() << "seed " << kFieldSeed);
  // A ball's surface of 10 mm and a small one in a corner of the box: most of the box is far from both.
  RbfModel model = model_of(6000);
  for (std::size_t i = 0; i < 3000; ++i) {
    model.centres_mm.push_back(0.1 * model.centres_mm[2 * i] + Vec3::Constant(30.0));
    model.weights.push_back((i % 2 == 0 ? 1.0 : -1.0) * 0.01);
  }
  for (const double accuracy_mm : {1e-3, 1e-5}) {
    const RbfField field(model, accuracy_mm);
    EXPECT_GT(field.value_error_mm(), 0.0);  // by fast sums
    std::vector<Vec3> places_mm;
    for (std::uint64_t n = 0; n < 400; ++n) {
      places_mm.emplace_back(Vec3::Constant(10.0) + test::random_place(kFieldSeed + 5, n, 21.0));
      places_mm.emplace_back(Vec3::Constant(10.0) + test::random_place(kFieldSeed + 6, n, 60.0));
    }
    std::vector<double> values(places_mm.size());
    std::vector<Vec3> gradients(places_mm.size());
    field.evaluate(places_mm, values, gradients);
    for (std::size_t i = 0; i < places_mm.size(); ++i) {
      const auto sum = test::plain_sum(model.kernel, 0.0, model.centres_mm, model.weights, places_mm[i]);
      EXPECT_NEAR(values[i], sum.value + test::plain_polynomial(model, places_mm[i]), accuracy_mm);
      EXPECT_LT((gradients[i] - sum.gradient - Vec3::Constant(0.1)).norm(), accuracy_mm);
    }
  }
}

TEST(RbfField, GivesALatticeTheBitsOfItsPlaces) {
  for (const std::size_t count : {603U, 2500U}) {  // term by term, and by fast sums
    const RbfField field(model_of(count));
    std::vector<Vec3> places_mm;
    for (const double z : {-8.0, 0.0, 1.0}) {
      for (const double y : {-2.0, 3.0, 3.5}) {
        for (const double x : {-13.0, -4.0, 0.5, 6.0, 9.0, 9.25, 9.5, 20.0}) places_mm.emplace_back(x, y, z);
      }
    }
    std::vector<double> each(places_mm.size());
    std::vector<double> lattice(places_mm.size());
    for (std::size_t i = 0; i < each.size(); ++i) field.evaluate({&places_mm[i], 1}, {&each[i], 1}, {});
    field.evaluate(places_mm, lattice, {});
    EXPECT_EQ(lattice, each);
  }
}

TEST(RbfField, HasTheGradientThatDifferencesOfItsValuesGive) {
  SCOPED_TRACE(::testing::Message() << "seed " << kFieldSeed);
  const RbfField field(model_of(1000));
  for (std::uint64_t n = 0; n < 100; ++n) {
    const Vec3 p = test::random_place(kFieldSeed + 3, n, 12.0);
    double value = 0.0;
    Vec3 gradient;
    field.evaluate({&p, 1}, {&value, 1}, {&gradient, 1});
    for (int axis = 0; axis < 3; ++axis) {
      constexpr double kStepMm = 1e-5;
      const std::vector<Vec3> ends{p - kStepMm * Vec3::Unit(axis), p + kStepMm * Vec3::Unit(axis)};
      std::vector<double> values(2);
      field.evaluate(ends, values, {});
      // Rounding: 1e-14 of a sum of magnitudes of about 100 over 2e-5 mm.
      EXPECT_NEAR(gradient[axis], (values[1] - values[0]) / (2.0 * kStepMm), 1e-6);
    }
  }
}

TEST(RbfField, GivesTheSameBitsOneByOneTogetherAndAtAnyNumberOfThreads) {
  SCOPED_TRACE(::testing::Message() << "seed " << kFieldSeed);
  for (const std::size_t count : {603U, 2500U}) {
    const std::vector<Vec3> points_mm = test::random_points(301, kFieldSeed + 4, 14.0);
    std::vector<double> one(301), two(301), without(301);
    std::vector<Vec3> gradient_one(301), gradient_two(301);
    {
      const tbb::global_control serial(tbb::global_control::max_allowed_parallelism, 1);
      RbfField(model_of(count)).evaluate(points_mm, one, gradient_one);
    }
    const tbb::global_control parallel(tbb::global_control::max_allowed_parallelism, 2);
    const RbfField field(model_of(count));
    field.evaluate(points_mm, two, gradient_two);
    field.evaluate(points_mm, without, {});
    EXPECT_EQ(one, two);
    EXPECT_EQ(one, without);
    EXPECT_EQ(gradient_one, gradient_two);
    const RbfField copy = field;  // NOLINT(performance-unnecessary-copy-initialization): copies share the sums
    for (std::size_t i = 0; i < 301; ++i) {
      double alone = 0.0;
      copy.evaluate({&points_mm[i], 1}, {&alone, 1}, {});
      EXPECT_EQ(alone, one[i]);
    }
  }
}

TEST(RbfField, IsSummedTermByTermWhereNoFastSumIsAccurateEnough) {
  const RbfModel model = model_of(2500);
  const RbfField field(model, 1e-20);
  EXPECT_EQ(field.value_error_mm(), 0.0);
  EXPECT_EQ(field.gradient_error(), 0.0);
  const std::vector<Vec3> places_mm(model.centres_mm.begin(), model.centres_mm.begin() + 50);
  std::vector<double> sums(places_mm.size());
  detail::direct_sums(model.kernel, model.low_pass_mm, model.centres_mm, model.weights, places_mm, sums, {});
  std::vector<double> values_mm(places_mm.size());
  field.evaluate(places_mm, values_mm, {});
  for (std::size_t i = 0; i < places_mm.size(); ++i) {
    EXPECT_EQ(values_mm[i], sums[i] + polynomial_value(model.kernel, model.polynomial, places_mm[i] - model.origin_mm));
  }
}

TEST(RbfField, RejectsAnAccuracyOfNothingAndModelsThatDoNotFit) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(test::error_of([] { RbfField(model_of(20), 0.0); }), testing::HasSubstr("accuracy above 0"));
  EXPECT_THAT(test::error_of([&] { RbfField(model_of(20), nan); }), testing::HasSubstr("accuracy above 0"));
  RbfModel bad = model_of(20);
  bad.weights.pop_back();
  EXPECT_THAT(test::error_of([&] { RbfField{bad}; }), testing::HasSubstr("a weight for each of 20"));
}

}  // namespace
}  // namespace spinaltap
