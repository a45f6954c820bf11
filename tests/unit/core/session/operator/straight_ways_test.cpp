#include "core/session/operator/straight_ways.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "apps/spinaltap/bench/drill_workload.h"
#include "core/base/random.h"
#include "core/tool/bit_profile.h"

namespace spinaltap {
namespace {

constexpr double kNoLimit = 1000.0;
const DrillBit kDrill{3.0, 50.0, 5.0};
const Vec3 kLineAxis = Vec3(0.3, -0.5, 0.8).normalized();
const Vec3 kLineStart(10.0, 200.0, -600.0);

std::vector<ToolInput> inputs_of(const std::vector<Pose>& poses) {
  std::vector<ToolInput> inputs(poses.size());
  for (std::size_t n = 0; n < poses.size(); ++n) inputs[n].pose = poses[n];
  return inputs;
}

std::vector<ToolInput> straight(double from_mm, double to_mm, double step_mm) {
  std::vector<ToolInput> inputs;
  const auto count = static_cast<int>(std::lround(std::abs(to_mm - from_mm) / step_mm));
  for (int n = 0; n <= count; ++n) {
    inputs.push_back({.pose = {kLineStart + (from_mm + (to_mm - from_mm) * n / count) * kLineAxis, kLineAxis}});
  }
  return inputs;
}

TEST(StraightWays, OfASteadyOperatorAreOneFromItsFirstPoseToItsLast) {
  for (const BitShape shape : {BitShape::drill, BitShape::round_burr}) {
    DrillBit bit = kDrill;
    bit.shape = shape;
    bit.shank_diameter_mm = 2.0;
    const std::vector<ToolInput> inputs = straight(0.0, 40.0, shape == BitShape::drill ? 0.7 : 0.001);
    const std::vector<BitWay> ways = straight_ways(inputs, bit, kNoLimit);
    ASSERT_EQ(ways.size(), 1U);
    EXPECT_LT((ways[0].start.tip_mm - kLineStart).norm(), 1e-9);
    EXPECT_LT((ways[0].end.tip_mm - inputs.back().pose.tip_mm).norm(), 1e-9);
  }
}

TEST(StraightWays, GoOnTheSameLineAfterTheOperatorDrewBack) {
  std::vector<ToolInput> inputs = straight(0.0, 10.0, 0.01);
  for (const ToolInput& input : straight(10.0, 5.0, 0.01)) inputs.push_back(input);
  for (const ToolInput& input : straight(5.0, 12.0, 0.01)) inputs.push_back(input);
  const std::vector<BitWay> ways = straight_ways(inputs, kDrill, kNoLimit);
  ASSERT_EQ(ways.size(), 1U);
  EXPECT_NEAR((ways[0].end.tip_mm - kLineStart).norm(), 12.0, 1e-9);
}

TEST(StraightWays, LeaveOutPosesThatTookNothing) {
  std::vector<ToolInput> inputs = straight(0.0, 5.0, 0.01);
  ToolInput off{.pose = {kLineStart + 20.0 * kLineAxis, kLineAxis}, .spindle_on = false};
  inputs.push_back(off);
  ToolInput no_number{.pose = {Vec3::Constant(std::numeric_limits<double>::quiet_NaN()), kLineAxis}};
  inputs.push_back(no_number);
  inputs.push_back({.pose = {kLineStart + 30.0 * kLineAxis, Vec3::Zero()}});
  const std::vector<BitWay> ways = straight_ways(inputs, kDrill, kNoLimit);
  ASSERT_EQ(ways.size(), 1U);
  EXPECT_NEAR((ways[0].end.tip_mm - kLineStart).norm(), 5.0, 1e-9);
  EXPECT_TRUE(straight_ways({&off, 1}, kDrill, kNoLimit).empty());
}

TEST(StraightWays, DoNotFollowAJump) {
  const Vec3 aside = kLineAxis.unitOrthogonal();
  std::vector<ToolInput> inputs = straight(0.0, 1.0, 0.01);
  inputs.push_back({.pose = {kLineStart + 60.0 * aside, kLineAxis}});
  EXPECT_EQ(straight_ways(inputs, kDrill, 50.0).size(), 2U);
  // Within the limit the way is cut: one line for each 0.02 mm of it, but for those that rounding puts between two.
  EXPECT_GT(straight_ways(inputs, kDrill, 100.0).size(), 2000U);
}

/// How far, at most, the union of the ways and that of all poses differ at some places near the tip's way, mm.
double difference_mm(const std::vector<ToolInput>& inputs, const std::vector<BitWay>& ways, const DrillBit& bit) {
  const BitProfile profile(bit);
  double max_mm = 0.0;
  for (std::uint64_t n = 0; n < 300; ++n) {
    const Pose& pose =
        inputs[static_cast<std::size_t>(random_uniform(1, n) * static_cast<double>(inputs.size() - 1))].pose;
    const double angle = 2.0 * std::numbers::pi * random_uniform(2, n);
    const Vec3 u = pose.axis.unitOrthogonal();
    const Vec3 out = std::cos(angle) * u + std::sin(angle) * pose.axis.cross(u);
    const Vec3 p_mm = pose.tip_mm - (8.0 * random_uniform(3, n) - 1.0) * pose.axis + 2.0 * random_uniform(4, n) * out;
    double by_poses_mm = std::numeric_limits<double>::infinity();
    for (const ToolInput& input : inputs)
      by_poses_mm = std::min(by_poses_mm, bit_distance_mm(profile, input.pose, p_mm));
    double by_ways_mm = std::numeric_limits<double>::infinity();
    for (const BitWay& way : ways) {
      const double way_mm = (way.end.tip_mm - way.start.tip_mm).norm();
      by_ways_mm = std::min(by_ways_mm, bit_distance_mm(profile.lengthened(way_mm), way.end, p_mm));
    }
    // Deep inside, distances are those to the union's parts, not to its surface.
    if (std::max(by_poses_mm, by_ways_mm) < -0.3) continue;
    max_mm = std::max(max_mm, std::abs(by_poses_mm - by_ways_mm));
  }
  return max_mm;
}

TEST(StraightWays, OfATremblingOperatorAreFewAndTakeWhatItsPosesTake) {
  const std::vector<Pose> all = workload_poses(WorkloadMotion::tremor);
  const std::vector<ToolInput> inputs = inputs_of({all.begin(), all.begin() + 8000});
  const std::vector<BitWay> ways = straight_ways(inputs, kDrill, kNoLimit);
  EXPECT_LT(ways.size(), inputs.size() / 10);
  // Lines are rounded to 0.02 mm where they pass, and the bit's cone leans by 0.3.
  EXPECT_LT(difference_mm(inputs, ways, kDrill), 0.03);
}

TEST(StraightWays, OfABitThatTurnsTakeWhatItsPosesTake) {
  std::vector<ToolInput> inputs;
  for (int n = 0; n <= 400; ++n) {
    const double angle = 0.1 * n / 400.0;
    const Vec3 axis = (std::cos(angle) * kLineAxis + std::sin(angle) * kLineAxis.unitOrthogonal()).normalized();
    inputs.push_back({.pose = {kLineStart + 0.02 * n * kLineAxis, axis}});
  }
  EXPECT_LT(difference_mm(inputs, straight_ways(inputs, kDrill, kNoLimit), kDrill), 0.03);
}

}  // namespace
}  // namespace spinaltap
