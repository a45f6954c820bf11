#include "core/session/operator/path_motion.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <vector>

#include "apps/spinaltap/bench/drill_workload.h"
#include "core/base/error.h"
#include "tests/support/nan.h"

namespace spinaltap {
namespace {

using test::kNan;

DrillPath paper_path() {
  const Vec3 entry_mm(40.0, 120.0, -300.0);
  return {"paper", entry_mm, entry_mm + 37.8 * Vec3(-0.36, -0.8, 0.48), {}};
}

/// Distance from p to the path's line.
double off_line_mm(const DrillPath& path, const Vec3& p) { return (p - path.entry_mm).cross(path.direction()).norm(); }

constexpr std::size_t kSamples = 10'000;  // 10 s at 1 kHz

PathMotion tool_operator(std::uint64_t seed = 1) { return {workload_path(3.0), {.tremor_mm = 0.1, .seed = seed}}; }

std::vector<double> tremor_along(const PathMotion& motion, Eigen::Index axis, std::size_t count = kSamples) {
  std::vector<double> samples;
  for (std::size_t index = 0; index < count; ++index) samples.push_back(motion.tremor_mm(index)[axis]);
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

TEST(PathMotion, TremblesAlongEveryAxisLikeOneSinusoidOfItsAmplitude) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const PathMotion motion = tool_operator(seed);
    // Five sinusoids of 0.1 mm / sqrt(5), over 1000 s all but orthogonal: the rms of one of 0.1 mm. Of any two the
    // frequencies differ by 0.4 Hz or more, so that their products' mean is below 1 / (2 pi 0.4 1000) = 4e-4 of a
    // square.
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(std::sqrt(mean_square(tremor_along(motion, axis, 1'000'000))), 0.1 / std::sqrt(2.0), 2e-4) << seed;
    }
  }
}

TEST(PathMotion, DoesNotTrembleTheSameSecondAgain) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const PathMotion motion = tool_operator(seed);
    // By any whole number of tenths of a second from 1 to 30 s, the tremor is another one: of one that repeats, the
    // mean square of the difference is 0, of two that have nothing in common twice the tremor's own.
    for (std::size_t later = 1000; later <= 30'000; later += 100) {
      double difference = 0.0;
      for (std::size_t n = 0; n < 2000; n += 5) {
        difference += (motion.tremor_mm(n + later) - motion.tremor_mm(n)).squaredNorm() / 400.0;
      }
      EXPECT_GT(difference, 0.1 * 3.0 * 0.1 * 0.1) << seed << ": " << later << " ms";
    }
  }
}

TEST(PathMotion, TremblesAtEightToTwelveHertz) {
  const PathMotion motion = tool_operator();
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const std::vector<double> samples = tremor_along(motion, axis);
    EXPECT_GT(mean_square_in_band(samples), 0.99 * mean_square(samples));
  }
}

TEST(PathMotion, FeedsFromTheEntryToTheTargetButForTheTremor) {
  const DrillPath path = workload_path(3.0);
  for (const double offset_mm : {0.0, 1.2}) {
    const PathMotion motion(path, {.line = {.offset_mm = offset_mm}});
    ASSERT_EQ(motion.cycle_count(), 37'800U);
    EXPECT_NEAR((motion.pose(0).tip_mm - path.entry_mm).norm(), offset_mm, 1e-9);
    EXPECT_NEAR((motion.pose(37'800).tip_mm - path.target_mm).norm(), offset_mm, 1e-9);
    EXPECT_NEAR((motion.pose(501).tip_mm - motion.pose(500).tip_mm).norm(), 0.001, 1e-9);
  }
  const PathMotion trembling = tool_operator();
  // Five sinusoids at their tops along three axes.
  const double max_mm = 0.1 * std::sqrt(5.0) * std::sqrt(3.0);
  EXPECT_LT((trembling.pose(0).tip_mm - path.entry_mm).norm(), max_mm);
  EXPECT_LT((trembling.pose(37'800).tip_mm - path.target_mm).norm(), max_mm);
  EXPECT_LT((trembling.pose(20'000).axis - path.direction()).norm(), 1e-14);
}

TEST(PathMotion, AtAFeedIsThatInItsSteps) {
  const std::vector<Pose> lock_step = workload_poses(WorkloadMotion::off_path);
  const PathMotion motion(workload_path(3.0), {.line = {.offset_mm = 1.2}});
  EXPECT_LT((motion.pose(12'345).tip_mm - lock_step[12'345].tip_mm).norm(), 1e-9);
}

TEST(PathMotion, FollowsFromItsSeedAndIndexAlone) {
  const PathMotion first = tool_operator(7);
  const PathMotion again = tool_operator(7);
  const PathMotion other = tool_operator(8);
  for (const std::size_t index : {37'000U, 5U, 12'000U, 5U}) {
    EXPECT_EQ(first.pose(index).tip_mm, again.pose(index).tip_mm);
    EXPECT_GT((first.pose(index).tip_mm - other.pose(index).tip_mm).norm(), 1e-4);
  }
}

TEST(PathMotion, TakesAsManyCyclesAsTheWayHoldsSteps) {
  EXPECT_EQ(PathMotion(paper_path(), in_steps_of(0.001)).cycle_count(), 37'800U);
  EXPECT_EQ(PathMotion(paper_path(), in_steps_of(0.001, {.lead_in_mm = 4.2})).cycle_count(), 42'000U);
  EXPECT_EQ(PathMotion(paper_path(), in_steps_of(1.0)).cycle_count(), 38U);
}

TEST(PathMotion, EndsAtTheTargetWithoutDrift) {
  const DrillPath path = paper_path();
  for (const double step_mm : {0.001, 0.0007, 0.05, 1.0, 50.0}) {
    const PathMotion motion(path, in_steps_of(step_mm, {.lead_in_mm = 3.0}));
    EXPECT_LT((motion.pose(0).tip_mm - (path.entry_mm - 3.0 * path.direction())).norm(), 1e-9);
    EXPECT_LT((motion.pose(motion.cycle_count()).tip_mm - path.target_mm).norm(), 1e-9) << step_mm;
    EXPECT_NEAR(motion.depth_mm(motion.cycle_count()), 37.8, 1e-9);
    EXPECT_LT((motion.pose(1).axis - path.direction()).norm(), 1e-14);
  }
}

TEST(PathMotion, StaysOnItsLineAtEvenSteps) {
  const DrillPath path = paper_path();
  const PathMotion motion(path, in_steps_of(0.001));
  for (std::size_t i = 0; i < motion.cycle_count(); i += 997) {
    EXPECT_LT(off_line_mm(path, motion.pose(i).tip_mm), 1e-9);
    EXPECT_NEAR((motion.pose(i).tip_mm - path.entry_mm).norm(), 0.001 * static_cast<double>(i), 1e-9);
    EXPECT_NEAR((motion.pose(i + 1).tip_mm - motion.pose(i).tip_mm).norm(), 0.001, 1e-9);
  }
}

TEST(PathMotion, RunsBesideThePathByItsOffset) {
  const DrillPath path = paper_path();
  const PathMotion motion(path, in_steps_of(0.1, {.lead_in_mm = 2.0, .offset_mm = 1.2}));
  for (std::size_t i = 0; i <= motion.cycle_count(); ++i) {
    EXPECT_NEAR(off_line_mm(path, motion.pose(i).tip_mm), 1.2, 1e-9);
    EXPECT_NEAR((motion.pose(i).tip_mm - path.entry_mm).dot(path.direction()), motion.depth_mm(i), 1e-9);
  }
}

TEST(PathMotion, MeetsThePathInItsMiddleWhenTilted) {
  const DrillPath path = paper_path();
  const PathMotion motion(path, in_steps_of(0.1, {.lead_in_mm = 5.0, .tilt_deg = 3.0}));
  EXPECT_NEAR(std::acos(motion.pose(0).axis.dot(path.direction())), 3.0 * std::numbers::pi / 180.0, 1e-9);
  const Vec3 middle_mm = 0.5 * (path.entry_mm + path.target_mm);
  double nearest_mm = 1e9;
  for (std::size_t i = 0; i <= motion.cycle_count(); ++i) {
    nearest_mm = std::min(nearest_mm, (motion.pose(i).tip_mm - middle_mm).norm());
    // The tip leaves the path's line by the sine of the tilt.
    EXPECT_NEAR(off_line_mm(path, motion.pose(i).tip_mm),
                std::abs(motion.depth_mm(i) - 18.9) * std::sin(3.0 * std::numbers::pi / 180.0), 1e-9);
  }
  EXPECT_LT(nearest_mm, 1e-9);  // 18.9 mm is a whole number of steps
}

TEST(PathMotion, PassesThePathAtItsOffsetWhenTiltedToo) {
  const DrillPath path = paper_path();
  const PathMotion motion(path, in_steps_of(0.1, {.offset_mm = -0.7, .tilt_deg = -20.0}));
  double nearest_mm = 1e9;
  for (std::size_t i = 0; i <= motion.cycle_count(); ++i) {
    nearest_mm = std::min(nearest_mm, off_line_mm(path, motion.pose(i).tip_mm));
  }
  EXPECT_NEAR(nearest_mm, 0.7, 1e-9);
}

TEST(PathMotion, RejectsWhatIsNoMotion) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  const DrillPath path = workload_path(3.0);
  const auto at_feed = [](double mm_s) {
    PathMotionOptions options;
    options.feed.steps = {{0.0, mm_s}};
    return options;
  };
  for (const PathMotionOptions& options :
       {at_feed(0.0), at_feed(kNan), at_feed(1e-6), PathMotionOptions{.rate_hz = 0.0},
        PathMotionOptions{.rate_hz = -1.0}, PathMotionOptions{.rate_hz = kNan}, PathMotionOptions{.tremor_mm = -0.1},
        PathMotionOptions{.tremor_mm = kNan}}) {
    EXPECT_THROW(PathMotion(path, options), Error);
  }
  for (const double bad : {kNan, kInfinite, -kInfinite, 1e3}) {
    EXPECT_THROW(PathMotion(path, {.line = {.offset_mm = bad}}), Error) << bad;
    EXPECT_THROW(PathMotion(path, {.line = {.tilt_deg = bad}}), Error) << bad;
  }
  for (const double bad : {kNan, kInfinite, -0.1, -40.0}) {
    EXPECT_THROW(PathMotion(path, {.line = {.lead_in_mm = bad}}), Error) << bad;
  }
  for (const double bad : {kNan, 0.0, -0.001}) EXPECT_THROW(in_steps_of(bad), Error) << bad;
  EXPECT_THROW(PathMotion({"none", Vec3::Zero(), Vec3::Zero(), {}}, {}), Error);
}

}  // namespace
}  // namespace spinaltap
