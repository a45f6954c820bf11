#include "core/session/operator/drilled_hole.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace spinaltap {
namespace {

constexpr double kNoJumpMm = 1000.0;
const DrillBit kDrill{3.0, 50.0, 5.0};
const Vec3 kDrillAxis = Vec3(0.3, -0.5, 0.8).normalized();
const Vec3 kDrillStart(10.0, 200.0, -600.0);

std::vector<ToolInput> straight_inputs(double from_mm, double to_mm, int steps) {
  std::vector<ToolInput> inputs;
  for (int n = 0; n <= steps; ++n) {
    inputs.push_back({.pose = {kDrillStart + (from_mm + (to_mm - from_mm) * n / steps) * kDrillAxis, kDrillAxis}});
  }
  return inputs;
}

std::vector<std::size_t> pose_counts(const std::vector<std::vector<Pose>>& ways) {
  std::vector<std::size_t> counts;
  for (const std::vector<Pose>& way : ways) counts.push_back(way.size());
  return counts;
}

TEST(DrilledHole, LeavesOutPosesThatTookNothing) {
  std::vector<ToolInput> inputs = straight_inputs(0.0, 5.0, 10);
  inputs.push_back({.pose = {Vec3::Constant(std::numeric_limits<double>::quiet_NaN()), kDrillAxis}});
  inputs.push_back({.pose = {kDrillStart + 30.0 * kDrillAxis, Vec3::Zero()}});
  inputs.push_back({.pose = {kDrillStart + 6.0 * kDrillAxis, kDrillAxis}});
  inputs.push_back({.pose = {kDrillStart + 20.0 * kDrillAxis, kDrillAxis}, .spindle_on = false});
  inputs.push_back({.pose = {kDrillStart + 7.0 * kDrillAxis, kDrillAxis}});
  const DrilledHole hole = drilled_hole(inputs, kDrill, kNoJumpMm);
  EXPECT_EQ(pose_counts(hole.ways), (std::vector<std::size_t>{12, 1}));
  EXPECT_EQ(hole.ways[0].back().tip_mm, kDrillStart + 6.0 * kDrillAxis);
  const ToolInput off{.pose = {kDrillStart, kDrillAxis}, .spindle_on = false};
  EXPECT_TRUE(drilled_hole({&off, 1}, kDrill, kNoJumpMm).ways.empty());
}

TEST(DrilledHole, DoesNotFollowAJumpOfTipOrBase) {
  std::vector<ToolInput> inputs = straight_inputs(0.0, 1.0, 4);
  inputs.push_back({.pose = {kDrillStart + 60.0 * kDrillAxis.unitOrthogonal(), kDrillAxis}});
  EXPECT_EQ(pose_counts(drilled_hole(inputs, kDrill, 50.0).ways), (std::vector<std::size_t>{5, 1}));
  EXPECT_EQ(pose_counts(drilled_hole(inputs, kDrill, 100.0).ways), (std::vector<std::size_t>{6}));
  // The base, 50 mm behind the tip, moves by 50 mm times the chord of a right angle.
  inputs.back().pose = {inputs[4].pose.tip_mm, kDrillAxis.unitOrthogonal()};
  EXPECT_EQ(pose_counts(drilled_hole(inputs, kDrill, 70.0).ways), (std::vector<std::size_t>{5, 1}));
  EXPECT_EQ(pose_counts(drilled_hole(inputs, kDrill, 71.0).ways), (std::vector<std::size_t>{6}));
}

TEST(DrilledHole, GoesOnFromWhereTheBitStood) {
  const std::vector<ToolInput> inputs = straight_inputs(0.0, 1.0, 9);
  std::optional<Pose> last;
  const auto first = cutting_ways(std::span(inputs).first(4), kDrill, kNoJumpMm, last);
  EXPECT_EQ(pose_counts(first), (std::vector<std::size_t>{4}));
  ASSERT_TRUE(last);
  EXPECT_EQ(last->tip_mm, inputs[3].pose.tip_mm);
  const auto second = cutting_ways(std::span(inputs).subspan(4), kDrill, kNoJumpMm, last);
  ASSERT_EQ(pose_counts(second), (std::vector<std::size_t>{7}));
  EXPECT_EQ(second[0][0].tip_mm, inputs[3].pose.tip_mm);
}

}  // namespace
}  // namespace spinaltap
