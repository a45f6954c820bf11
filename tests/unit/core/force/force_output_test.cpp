#include "core/force/force_output.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/unit/core/engine/askew_block.h"

namespace spinaltap {
namespace {

constexpr double kCycleS = 0.001;

TEST(ForceOutput, GivesNothingBeforeTheFirstAndThatOneAfterIt) {
  ForceOutput output;
  EXPECT_EQ(output.at(1.0), Vec3::Zero());
  output.update(Vec3(1, 2, 3), 0.5);
  EXPECT_EQ(output.at(0.5), Vec3(1, 2, 3));
  EXPECT_EQ(output.at(0.6), Vec3(1, 2, 3));
}

TEST(ForceOutput, GoesOnAlongAFallAndHoldsAfterACycle) {
  ForceOutput output;
  output.update(Vec3(0, 0, 5), 0.0);
  output.update(Vec3(0, 0, 4), kCycleS);
  EXPECT_NEAR(output.at(1.0 * kCycleS).z(), 4.0, 1e-12);
  EXPECT_NEAR(output.at(1.25 * kCycleS).z(), 3.75, 1e-12);
  EXPECT_NEAR(output.at(2.0 * kCycleS).z(), 3.0, 1e-12);
  EXPECT_NEAR(output.at(7.0 * kCycleS).z(), 3.0, 1e-12);
}

TEST(ForceOutput, KeepsItsBoundsWhateverComes) {
  test::Draw draw(5);
  for (int run = 0; run < 200; ++run) {
    ForceOutput output;
    Vec3 before = Vec3::Zero();
    double time_s = draw(-10.0, 10.0);
    for (int cycle = 0; cycle < 50; ++cycle) {
      const bool is_free = draw(0.0, 1.0) < 0.3;
      const Vec3 force_n = is_free ? Vec3::Zero() : Vec3(draw(0.0, 30.0) * draw.direction());
      time_s += draw(0.0001, 0.002);
      output.update(force_n, time_s);
      EXPECT_EQ(output.at(time_s), force_n);
      for (double later_s = 0.0; later_s < 0.004; later_s += 0.0001) {
        const Vec3 out_n = output.at(time_s + later_s);
        ASSERT_LE(out_n.norm(), std::max(force_n.norm(), before.norm()) * (1.0 + 1e-12));
        ASSERT_GE(out_n.dot(force_n), -1e-12);
        // Contact that was lost is not felt, however fast the force was growing.
        if (is_free) {
          ASSERT_EQ(out_n, Vec3::Zero());
        }
      }
      before = force_n;
    }
  }
}

TEST(ForceOutput, AtTenKilohertzFollowsASmoothForceBetterThanHoldingIt) {
  // 20 Hz, some operators' fastest, from cycles at 1 kHz.
  const auto ground_truth_n = [](double time_s) { return 10.0 + 5.0 * std::sin(2.0 * 3.14159265 * 20.0 * time_s); };
  ForceOutput output;
  double worst_n = 0.0, worst_held_n = 0.0, worst_jump_n = 0.0;
  double before_n = ground_truth_n(0.0);
  for (int n = 0; n < 2'000; ++n) {
    const double time_s = 1e-4 * n;
    const double cycle_s = kCycleS * std::floor(time_s / kCycleS + 1e-9);
    if (n % 10 == 0) output.update(Vec3(0, 0, ground_truth_n(cycle_s)), cycle_s);
    const double out_n = output.at(time_s).z();
    if (n >= 20) {
      worst_n = std::max(worst_n, std::abs(out_n - ground_truth_n(time_s)));
      worst_held_n = std::max(worst_held_n, std::abs(ground_truth_n(cycle_s) - ground_truth_n(time_s)));
      worst_jump_n = std::max(worst_jump_n, std::abs(out_n - before_n));
    }
    before_n = out_n;
  }
  // Rising forces are not extrapolated beyond the last: there it is no better than holding, and falls are followed.
  EXPECT_LE(worst_n, worst_held_n + 1e-9);
  EXPECT_LE(worst_jump_n, 0.7);
}

TEST(ForceOutput, TakesTimesThatDoNotRiseAsANewBeginning) {
  ForceOutput output;
  output.update(Vec3(0, 0, 5), 1.0);
  output.update(Vec3(0, 0, 4), 1.0);
  EXPECT_EQ(output.at(1.1), Vec3(0, 0, 4));
  output.update(Vec3(0, 0, 3), 0.2);
  EXPECT_EQ(output.at(0.3), Vec3(0, 0, 3));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  output.update(Vec3(nan, 0, 0), 0.4);
  output.update(Vec3(9, 0, 0), nan);
  EXPECT_EQ(output.at(0.3), Vec3(0, 0, 3));
}

}  // namespace
}  // namespace spinaltap
