#include "core/rbf/rbf_field.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "core/base/random.h"

namespace spinaltap {
namespace {

TEST(RbfField, IsTheSumThatItsWeightsSay) {
  Eigen::VectorXd weights(6);
  weights << 2.0, -0.5, 1.0, 0.1, 0.2, 0.3;
  const RbfField field({Vec3(1, 0, 0), Vec3(0, 3, 0)}, weights, Vec3(10, 10, 10));
  EXPECT_EQ(field.centre_count(), 2U);
  const Vec3 p(1, 3, 4);
  double value = 0.0;
  Vec3 gradient;
  field.evaluate({&p, 1}, {&value, 1}, {&gradient, 1});
  // |p - c1| = 5, |p - c2| = sqrt(17), p - origin = (-9, -7, -6).
  EXPECT_NEAR(value, 2.0 * 5.0 - 0.5 * std::sqrt(17.0) + 1.0 - 0.9 - 1.4 - 1.8, 1e-14);
  const Vec3 expected = 2.0 * Vec3(0, 3, 4) / 5.0 - 0.5 * Vec3(1, 0, 4) / std::sqrt(17.0) + Vec3(0.1, 0.2, 0.3);
  EXPECT_LT((gradient - expected).norm(), 1e-14);
}

TEST(RbfField, LeavesOutACentresOwnTermFromTheGradientThere) {
  Eigen::VectorXd weights(6);
  weights << 2.0, -0.5, 1.0, 0.1, 0.2, 0.3;
  const RbfField field({Vec3(1, 0, 0), Vec3(0, 3, 0)}, weights, Vec3::Zero());
  const Vec3 p(1, 0, 0);
  double value = 0.0;
  Vec3 gradient;
  field.evaluate({&p, 1}, {&value, 1}, {&gradient, 1});
  EXPECT_LT((gradient - (-0.5 * Vec3(1, -3, 0) / std::sqrt(10.0) + Vec3(0.1, 0.2, 0.3))).norm(), 1e-14);
}

TEST(RbfField, GivesTheSameBitsOneByOneTogetherAndAtAnyNumberOfThreads) {
  constexpr std::uint64_t kSeed = 12;
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  std::vector<Vec3> centres_mm, points_mm;
  Eigen::VectorXd weights(604);  // more than two blocks of centres, and a part of one
  for (Eigen::Index i = 0; i < weights.size(); ++i) weights[i] = random_normal(kSeed, static_cast<std::uint64_t>(i));
  for (std::uint64_t n = 0; n < 900; ++n) {
    const Vec3 p(random_normal(kSeed + 1, 3 * n), random_normal(kSeed + 1, 3 * n + 1),
                 random_normal(kSeed + 1, 3 * n + 2));
    (n < 600 ? centres_mm : points_mm).push_back(p);
  }
  const RbfField field(centres_mm, weights, Vec3(1, 2, 3));
  std::vector<double> one(300), two(300), without(300);
  std::vector<Vec3> gradient_one(300), gradient_two(300);
  {
    const tbb::global_control serial(tbb::global_control::max_allowed_parallelism, 1);
    field.evaluate(points_mm, one, gradient_one);
  }
  const tbb::global_control parallel(tbb::global_control::max_allowed_parallelism, 2);
  field.evaluate(points_mm, two, gradient_two);
  field.evaluate(points_mm, without, {});
  EXPECT_EQ(one, two);
  EXPECT_EQ(one, without);
  EXPECT_EQ(gradient_one, gradient_two);
  for (std::size_t i = 0; i < 300; ++i) {
    double alone = 0.0;
    field.evaluate({&points_mm[i], 1}, {&alone, 1}, {});
    EXPECT_EQ(alone, one[i]);
    double sum = weights[600] + weights.tail(3).dot(points_mm[i] - Vec3(1, 2, 3));
    for (std::size_t c = 0; c < 600; ++c) {
      sum += weights[static_cast<Eigen::Index>(c)] * (points_mm[i] - centres_mm[c]).norm();
    }
    EXPECT_NEAR(one[i], sum, 1e-11);  // 600 terms of about 2, in another order
  }
}

TEST(RbfField, RefusesWhatIsNotANumberOrDoesNotFit) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(5);
  EXPECT_THROW(RbfField({Vec3::Zero(), Vec3::Ones()}, ones, Vec3::Zero()), Error);
  EXPECT_THROW(RbfField({Vec3(nan, 0, 0)}, ones, Vec3::Zero()), Error);
  EXPECT_THROW(RbfField({Vec3::Zero()}, nan * ones, Vec3::Zero()), Error);
  EXPECT_THROW(RbfField({Vec3::Zero()}, ones, Vec3(0, nan, 0)), Error);
}

}  // namespace
}  // namespace spinaltap
