#include "core/session/operator/force_controlled.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "core/base/error.h"
#include "tests/support/drill_block.h"
#include "tests/support/nan.h"

namespace spinaltap {
namespace {

using test::kNan;

constexpr double kTurnsPerS = 1250.0 / 60.0;

double soft_slab(double depth_mm) { return depth_mm >= 0.0 && depth_mm <= 8.0 ? 500.0 : kNan; }

/// The feed (mm/s) at which thrust and damping are the push, found apart from the operator.
double balanced_feed_mm_s(const CuttingResistance& bone, double push_n, double damping_n_s_mm) {
  double low = 0.0, high = 1e4;
  for (int n = 0; n < 200; ++n) {
    const double middle = 0.5 * (low + high);
    (bone.thrust_n(middle / kTurnsPerS) + damping_n_s_mm * middle < push_n ? low : high) = middle;
  }
  return low;
}

/// Asks the operator `cycles` times, the bone being what it is.
void ask(ForceControlled& tool_operator, int cycles, const CuttingResistance& bone, bool stop = false) {
  ToolFeedback feedback;
  feedback.force.resistance = bone;
  feedback.stop = stop;
  for (int n = 0; n < cycles; ++n) tool_operator.next(feedback);
}

DrillPath slab_path() { return test::DrillBlock(soft_slab, 60.0).path; }

TEST(ForceControlled, ReachesTheFeedAtWhichThrustAndDampingAreItsPush) {
  const DrillBit bit = twist_drill(3.0, 60.0, 118.0, 0.48);
  for (const double hu : {300.0, 600.0}) {
    const CuttingResistance bone = resistance_of_block(bit, {}, hu);
    for (const double push_n : {15.0, 30.0, 60.0}) {
      ForceControlled tool_operator(slab_path(), {.push_n = push_n});
      ask(tool_operator, 1'000, bone);
      const double expected_mm_s = balanced_feed_mm_s(bone, push_n, 2.0);
      EXPECT_NEAR(tool_operator.feed_mm_s(), expected_mm_s, 1e-6 * expected_mm_s + 1e-9)
          << hu << " HU, " << push_n << " N";
    }
  }
}

TEST(ForceControlled, DoesSoInASession) {
  test::DrillBlock block([](double depth_mm) { return depth_mm >= 0.0 ? 500.0 : kNan; }, 20.0);
  const auto session = block.session();
  ForceControlled tool_operator(block.path, {.line = {.lead_in_mm = 1.0}, .push_n = 20.0});
  const CuttingResistance resistance = resistance_of_block(block.path.bit, block.material, 500.0);
  const double expected_mm_s = balanced_feed_mm_s(resistance, 20.0, 2.0);
  double sum_mm_s = 0.0, sum_n = 0.0;
  int count = 0;
  run_session(*session, tool_operator, [&](const Cycle& cycle) {
    if (cycle.depth_mm < 8.0 || cycle.depth_mm > 18.0) return;
    sum_mm_s += tool_operator.feed_mm_s();
    sum_n += cycle.force.thrust_n;
    ++count;
  });
  ASSERT_GT(count, 100);
  EXPECT_NEAR(sum_mm_s / count, expected_mm_s, 0.03 * expected_mm_s);
  EXPECT_NEAR(sum_n / count, 20.0 - 2.0 * expected_mm_s, 0.03 * 20.0);
  // It sees the target coming, and lets go there.
  EXPECT_NEAR(session->last().depth_mm, 20.0, 0.1);
  EXPECT_GE(session->last().depth_mm, 20.0);
}

TEST(ForceControlled, StandsWhereTheChiselEdgeHoldsIt) {
  CuttingResistance bone = resistance_of_block(twist_drill(3.0, 60.0, 118.0, 0.48), {}, 1200.0);
  ASSERT_GT(bone.chisel_n, 20.0);
  ForceControlled weak(slab_path(), {.push_n = 0.9 * bone.chisel_n, .max_push_n = 0.0});
  ask(weak, 500, bone);
  const double stands_mm = weak.depth_mm();
  ask(weak, 2'000, bone);
  EXPECT_EQ(weak.depth_mm(), stands_mm);
  EXPECT_EQ(weak.feed_mm_s(), 0.0);
  ForceControlled strong(slab_path(), {.push_n = 1.1 * bone.chisel_n});
  ask(strong, 2'500, bone);
  EXPECT_GT(strong.feed_mm_s(), 0.0);
}

TEST(ForceControlled, GivesUpWhereItCannotGoOn) {
  CuttingResistance bone;
  bone.chisel_n = 1e3;
  ForceControlled tool_operator(slab_path(), {.longest_s = 2.0});
  ToolFeedback feedback;
  feedback.force.resistance = bone;
  int cycles = 0;
  while (tool_operator.next(feedback)) ++cycles;
  EXPECT_NEAR(cycles, 2'000, 2);
}

TEST(ForceControlled, PlungesTheFurtherTheHarderItPushes) {
  double before_mm = 0.0;
  for (const double push_n : {15.0, 25.0, 40.0, 60.0}) {
    test::DrillBlock block(soft_slab, 60.0);
    const auto session = block.session();
    ForceControlled tool_operator(block.path, {.line = {.lead_in_mm = 1.0}, .push_n = push_n});
    run_session(*session, tool_operator);
    const auto through = test::events_of(*session, EventKind::breakthrough);
    ASSERT_EQ(through.size(), 1U) << push_n;
    EXPECT_NEAR(through[0].depth_mm, 8.0, 0.1);
    const auto over = test::events_of(*session, EventKind::plunge);
    ASSERT_EQ(over.size(), 1U) << push_n;
    EXPECT_NEAR(over[0].value, session->last().depth_mm - through[0].depth_mm, 0.01);
    EXPECT_GT(over[0].value, before_mm) << push_n;
    before_mm = over[0].value;
    RecordProperty("plunge_depth_mm_at_" + std::to_string(static_cast<int>(push_n)), std::to_string(over[0].value));
    // Until the bit's cone is through as well it cuts; then it goes as fast as its damping lets it, until it reacts.
    const double expected_mm = block.path.bit.tip_length_mm + push_n / 2.0 * 0.2;
    EXPECT_NEAR(over[0].value, expected_mm, 0.1 * expected_mm) << push_n;
  }
}

TEST(ForceControlled, StopsAReactionTimeAfterItIsAskedTo) {
  const CuttingResistance bone = resistance_of_block(twist_drill(3.0, 60.0, 118.0, 0.48), {}, 500.0);
  for (const double reaction_s : {0.0, 0.1, 0.2, 0.5}) {
    ForceControlled tool_operator(slab_path(), {.push_n = 20.0, .reaction_s = reaction_s});
    ask(tool_operator, 1'500, bone);
    const double asked_mm = tool_operator.depth_mm();
    const double feed_mm_s = tool_operator.feed_mm_s();
    ask(tool_operator, 1'000, bone, true);
    EXPECT_EQ(tool_operator.feed_mm_s(), 0.0);
    EXPECT_NEAR(tool_operator.depth_mm() - asked_mm, reaction_s * feed_mm_s, 0.002 * feed_mm_s + 0.005) << reaction_s;
    ToolFeedback feedback;
    EXPECT_FALSE(tool_operator.next(feedback).has_value()) << "it stood, and ended";
  }
}

TEST(ForceControlled, ComesAgainTheSame) {
  const auto poses = [](std::uint64_t seed) {
    test::DrillBlock block(soft_slab, 20.0);
    const auto session = block.session();
    ForceControlled tool_operator(block.path,
                                  {.line = {.lead_in_mm = 0.5}, .push_n = 20.0, .tremor_mm = 0.1, .seed = seed});
    std::vector<Vec3> tips_mm;
    run_session(*session, tool_operator, [&](const Cycle& cycle) { tips_mm.push_back(cycle.input.pose.tip_mm); });
    return tips_mm;
  };
  const std::vector<Vec3> first = poses(5);
  EXPECT_GT(first.size(), 500U);
  EXPECT_EQ(first, poses(5));
  EXPECT_NE(first, poses(6));
}

TEST(ForceControlled, RejectsOptionsWithoutSense) {
  for (const ForceControlOptions& options :
       {ForceControlOptions{.push_n = kNan}, ForceControlOptions{.push_n = -1.0}, ForceControlOptions{.mass_kg = 0.0},
        ForceControlOptions{.damping_n_s_mm = -1.0}, ForceControlOptions{.rate_hz = 0.0},
        ForceControlOptions{.spindle = {.rpm = 0.0}}, ForceControlOptions{.reaction_s = kNan},
        ForceControlOptions{.ramp_s = -1.0}, ForceControlOptions{.approach_mm_s = 0.0},
        ForceControlOptions{.noticed_share = 1.5}, ForceControlOptions{.longest_s = kNan},
        ForceControlOptions{.tremor_mm = kNan}, ForceControlOptions{.line = {.tilt_deg = kNan}}}) {
    EXPECT_THROW(ForceControlled(slab_path(), options), Error);
  }
}

}  // namespace
}  // namespace spinaltap
