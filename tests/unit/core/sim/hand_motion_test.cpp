#include "core/sim/hand_motion.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "core/base/error.h"
#include "core/sim/drill_workload.h"

namespace spinaltap {
namespace {

constexpr std::size_t kSamples = 10'000;  // 10 s at 1 kHz: whole periods of every sinusoid

HandMotion hand(std::uint64_t seed = 1) { return {workload_path(3.0), {.seed = seed}}; }

std::vector<double> tremor_along(const HandMotion& motion, Eigen::Index axis) {
  std::vector<double> samples;
  for (std::size_t index = 0; index < kSamples; ++index) samples.push_back(motion.tremor_mm(index)[axis]);
  return samples;
}

double mean_square(const std::vector<double>& samples) {
  double sum = 0.0;
  for (const double sample : samples) sum += sample * sample;
  return sum / static_cast<double>(samples.size());
}

/// The part of the mean square that lies within 7 to 13 Hz, by the discrete Fourier transform.
double mean_square_in_band(const std::vector<double>& samples) {
  constexpr double kHzPerBin = 0.1;
  double sum = 0.0;
  for (int bin = 70; bin <= 130; ++bin) {
    std::complex<double> coefficient = 0.0;
    const double turn = -2.0 * std::numbers::pi * kHzPerBin * bin / 1000.0;
    for (std::size_t n = 0; n < samples.size(); ++n) {
      coefficient += samples[n] * std::polar(1.0, turn * static_cast<double>(n));
    }
    sum += 2.0 * std::norm(coefficient / static_cast<double>(samples.size()));
  }
  return sum;
}

TEST(HandMotion, TremblesAlongEveryAxisLikeOneSinusoidOfItsAmplitude) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const HandMotion motion = hand(seed);
    // Five sinusoids of 0.1 mm / sqrt(5), orthogonal over whole periods: the rms of one of 0.1 mm.
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(std::sqrt(mean_square(tremor_along(motion, axis))), 0.1 / std::sqrt(2.0), 1e-9) << seed;
    }
  }
}

TEST(HandMotion, TremblesAtEightToTwelveHertz) {
  const HandMotion motion = hand();
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const std::vector<double> samples = tremor_along(motion, axis);
    EXPECT_GT(mean_square_in_band(samples), 0.99 * mean_square(samples));
  }
}

TEST(HandMotion, FeedsFromTheEntryToTheTargetButForTheTremor) {
  const DrillPath path = workload_path(3.0);
  for (const double offset_mm : {0.0, 1.2}) {
    const HandMotion motion(path, {.offset_mm = offset_mm, .tremor_mm = 0.0});
    ASSERT_EQ(motion.cycle_count(), 37'800U);
    EXPECT_NEAR((motion.pose(0).tip_mm - path.entry_mm).norm(), offset_mm, 1e-9);
    EXPECT_NEAR((motion.pose(37'800).tip_mm - path.target_mm).norm(), offset_mm, 1e-9);
    EXPECT_NEAR((motion.pose(501).tip_mm - motion.pose(500).tip_mm).norm(), 0.001, 1e-9);
  }
  const HandMotion trembling = hand();
  // Five sinusoids at their tops along three axes.
  const double most_mm = 0.1 * std::sqrt(5.0) * std::sqrt(3.0);
  EXPECT_LT((trembling.pose(0).tip_mm - path.entry_mm).norm(), most_mm);
  EXPECT_LT((trembling.pose(37'800).tip_mm - path.target_mm).norm(), most_mm);
  EXPECT_LT((trembling.pose(20'000).axis - path.direction()).norm(), 1e-14);
}

TEST(HandMotion, IsShiftedAsALockStepMotionIs) {
  const std::vector<Pose> lock_step = workload_poses(WorkloadMotion::off_path);
  const HandMotion motion(workload_path(3.0), {.offset_mm = 1.2, .tremor_mm = 0.0});
  EXPECT_LT((motion.pose(12'345).tip_mm - lock_step[12'345].tip_mm).norm(), 1e-9);
}

TEST(HandMotion, FollowsFromItsSeedAndIndexAlone) {
  const HandMotion first = hand(7);
  const HandMotion again = hand(7);
  const HandMotion other = hand(8);
  for (const std::size_t index : {37'000U, 5U, 12'000U, 5U}) {
    EXPECT_EQ(first.pose(index).tip_mm, again.pose(index).tip_mm);
    EXPECT_GT((first.pose(index).tip_mm - other.pose(index).tip_mm).norm(), 1e-4);
  }
}

TEST(HandMotion, RefusesWhatIsNoMotion) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const DrillPath path = workload_path(3.0);
  for (const HandOptions& options :
       {HandOptions{.feed_mm_s = 0.0}, HandOptions{.feed_mm_s = kNan}, HandOptions{.feed_mm_s = 1e-6},
        HandOptions{.rate_hz = 0.0}, HandOptions{.rate_hz = -1.0}, HandOptions{.offset_mm = kNan},
        HandOptions{.tremor_mm = -0.1}, HandOptions{.tremor_mm = kNan}}) {
    EXPECT_THROW(HandMotion(path, options), Error);
  }
}

}  // namespace
}  // namespace spinaltap
