// Sessions that drill the voxels of a region of a bone.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "core/base/error.h"
#include "core/files/recorded_setup.h"
#include "core/session/record/session_record.h"
#include "tests/unit/vdb/sim/voxel_ball.h"
#include "vdb/engine/occupied_voxels.h"
#include "vdb/sim/build_session.h"
#include "vdb/sim/drilled_bone.h"
#include "vdb/sim/replay.h"

namespace spinaltap {
namespace {

using test::kVoxelBall;
using test::path_through;
using test::slot_of;
using test::slot_setup;
using test::voxel_ball;
using test::voxel_setup;
using testing::HasSubstr;
using testing::ThrowsMessage;

SessionRecord record_of(const SessionSetup& setup, const std::vector<ToolInput>& inputs) {
  SessionRecord record;
  const BuiltSession built = build_session(voxel_ball(), setup);
  for (const ToolInput& input : inputs) record.cycles.push_back(recorded(built.session->step(input)));
  record.events.assign(built.session->events().begin(), built.session->events().end());
  record.is_whole = true;
  return record;
}

TEST(VoxelRegion, ThatHoldsAllOfTheToolsWayMakesNoDifference) {
  // The burr reaches 2 mm further aside than the 4 mm that it goes.
  const SessionSetup whole = slot_setup({}), part = slot_setup(6.5);
  const std::vector<ToolInput> inputs = slot_of(whole.path, 4.0);
  BuiltSession all = build_session(voxel_ball(), whole), again = build_session(voxel_ball(), part);
  EXPECT_GT(all.bone.occupied_count(), again.bone.occupied_count());
  std::size_t removed = 0;
  for (const ToolInput& input : inputs) {
    const Cycle &expected = all.session->step(input), &cycle = again.session->step(input);
    SCOPED_TRACE(cycle.index);
    removed += cycle.step.removed;
    ASSERT_EQ(cycle.step.removed, expected.step.removed);
    ASSERT_EQ(cycle.step.removed_hu, expected.step.removed_hu);
    ASSERT_EQ(cycle.state, expected.state);
    // Engines count places from the middle of what they have: the last digits may differ.
    ASSERT_NEAR((cycle.force.force_n - expected.force.force_n).norm(), 0.0, 1e-9);
    ASSERT_NEAR(cycle.force.torque_n_mm, expected.force.torque_n_mm, 1e-9);
  }
  EXPECT_GT(removed, 20'000U);
  ASSERT_EQ(again.session->events().size(), all.session->events().size());
  EXPECT_GT(again.session->events().size(), 1U);
  for (std::size_t n = 0; n < all.session->events().size(); ++n) {
    const SessionEvent &expected = all.session->events()[n], &event = again.session->events()[n];
    EXPECT_EQ(event.kind, expected.kind);
    EXPECT_EQ(event.cycle, expected.cycle);
    EXPECT_NEAR(event.value, expected.value, 1e-9);
  }
  // What is left within the region is the same as well, voxel by voxel.
  std::size_t within = 0;
  all.bone.voxels->for_each_occupied([&](const Eigen::Vector3i& voxel) {
    if (!part.region_mm->contains(all.bone.voxels->centre_mm(voxel))) return;
    ++within;
    EXPECT_TRUE(again.bone.voxels->is_occupied(voxel));
  });
  EXPECT_EQ(within, again.bone.voxels->occupied_count());
}

TEST(VoxelRegion, SaysWhereTheToolLeavesIt) {
  const SessionSetup whole = slot_setup({}), part = slot_setup(3.0);
  const std::vector<ToolInput> inputs = slot_of(whole.path, 4.0);
  const auto leaves = [](const SessionRecord& record) {
    return std::ranges::count(record.events, EventKind::outside_volume, &SessionEvent::kind);
  };
  EXPECT_EQ(leaves(record_of(whole, inputs)), 0);
  const SessionRecord record = record_of(part, inputs);
  ASSERT_EQ(leaves(record), 1);
  const auto event = std::ranges::find(record.events, EventKind::outside_volume, &SessionEvent::kind);
  // The ball, of 2 mm, has the least room where it goes along the axis that it is nearest to: aside by 4 mm at most.
  double beyond_mm = 0.0;
  for (const ToolInput& input : inputs) {
    const Vec3 centre_mm = input.pose.tip_mm - 2.0 * input.pose.axis;
    const Vec3 below = part.region_mm->min() - (centre_mm - Vec3::Constant(2.0));
    const Vec3 above = centre_mm + Vec3::Constant(2.0) - part.region_mm->max();
    beyond_mm = std::max(beyond_mm, below.cwiseMax(above).maxCoeff());
  }
  EXPECT_GT(beyond_mm, 0.5);
  EXPECT_NEAR(event->value, beyond_mm, 1e-9);
  EXPECT_GT(event->cycle, 200U) << "on its way aside";
}

TEST(VoxelRegion, TakesMemoryByItsVolume) {
  const DrillPath path = path_through({0.2, -0.9, 0.3});
  SessionSetup setup = voxel_setup(path);
  const std::size_t whole_bytes = DrilledBone(voxel_ball().model(), setup).memory_bytes();
  const double ball_mm3 = 4.0 / 3.0 * std::numbers::pi * std::pow(kVoxelBall.radius_mm, 3);
  // Cubes within the ball. Leaves of 0.8 mm that they cut are there as a whole.
  for (const double half_mm : {1.6, 2.4, 4.0}) {
    setup.region_mm =
        Box3(kVoxelBall.centre_mm - Vec3::Constant(half_mm), kVoxelBall.centre_mm + Vec3::Constant(half_mm));
    const DrilledBone part(voxel_ball().model(), setup);
    EXPECT_NEAR(1e-3 * static_cast<double>(part.occupied_count()), std::pow(2.0 * half_mm, 3),
                0.07 * std::pow(2.0 * half_mm, 3));
    const double share = static_cast<double>(part.memory_bytes()) / static_cast<double>(whole_bytes);
    EXPECT_LT(share, 1.1 * std::pow(2.0 * (half_mm + 0.8), 3) / ball_mm3) << half_mm;
  }
}

TEST(VoxelRegion, IsKeptInRecordsThatReplayBitForBit) {
  SessionSetup setup = slot_setup(3.0);
  setup.engine = EngineKind::automatic;
  const std::vector<ToolInput> inputs = slot_of(setup.path, 4.0);
  SessionRecord record = record_of(setup, inputs);
  record.setup = record_setup(setup);
  const Replay same = replay(record, "run.h5", voxel_ball());
  EXPECT_EQ(same.difference, "");
  EXPECT_EQ(same.cycles, inputs.size());
  EXPECT_EQ(same.events, record.events.size());
  EXPECT_TRUE(replay(record, "run.h5", voxel_ball(), EngineKind::automatic).is_same());
  EXPECT_THAT([&] { replay(record, "run.h5", voxel_ball(), EngineKind::leaf); },
              ThrowsMessage<Error>(HasSubstr("expected the engine voxel, found leaf")));
}

TEST(VoxelRegion, IsRejectedWhereItMakesNoSense) {
  const auto rejects = [](const std::function<void(SessionSetup&)>& change, const char* words) {
    SessionSetup setup = slot_setup(6.0);
    change(setup);
    EXPECT_THAT([&] { build_session(voxel_ball(), setup); }, ThrowsMessage<Error>(HasSubstr(words)));
  };
  rejects([](SessionSetup& setup) { setup.engine = EngineKind::ring; }, "expected the engine voxel, found ring");
  rejects([](SessionSetup& setup) { setup.region_mm = Box3(); }, "second corner");
  rejects([](SessionSetup& setup) { setup.region_mm = Box3(Vec3::Ones(), Vec3::Zero()); }, "second corner");
  rejects([](SessionSetup& setup) { setup.region_mm = Box3(Vec3::Constant(90.0), Vec3::Constant(91.0)); },
          "a region with bone in it");
  // Around the entry alone, 3 mm before the target.
  rejects(
      [](SessionSetup& setup) {
        setup.region_mm = Box3(setup.path.entry_mm - Vec3::Constant(2.0), setup.path.entry_mm + Vec3::Constant(2.0));
      },
      "within the region of the voxels");
}

TEST(VoxelSessions, OnlyARegionHasAnEnd) {
  const VoxelBone whole(voxel_ball().model(), {.voxel_mm = 0.3});
  const Box3 box_mm(kVoxelBall.centre_mm - Vec3::Constant(4.0), kVoxelBall.centre_mm + Vec3::Constant(4.0));
  const VoxelBone part(voxel_ball().model(), {.voxel_mm = 0.3, .region_mm = box_mm});
  const auto all = make_occupied_bone(whole, {});
  const auto some = make_occupied_bone(part, {});
  const BitProfile bit({2.0, 20.0, 2.0});
  const Vec3& middle_mm = kVoxelBall.centre_mm;
  const Pose pose{middle_mm + Vec3(0.0, 3.5, 0.0), Vec3::UnitZ()};
  EXPECT_EQ(all->past_end_mm(Vec3::Constant(1e5)), -std::numeric_limits<double>::infinity());
  EXPECT_EQ(all->beyond_side_mm(bit, pose, middle_mm), -std::numeric_limits<double>::infinity());
  EXPECT_NEAR(some->past_end_mm(middle_mm + Vec3(0.0, 0.0, 5.5)), 1.5, 1e-12);
  EXPECT_NEAR(some->past_end_mm(middle_mm), -4.0, 1e-12);
  // Only its tip has come deeper than the first contact; then all of a cone of 2 mm, which is 1 mm wide, and its shaft.
  EXPECT_NEAR(some->beyond_side_mm(bit, pose, pose.tip_mm), -0.5, 1e-12);
  EXPECT_NEAR(some->beyond_side_mm(bit, pose, pose.tip_mm - Vec3(0.0, 0.0, 2.0)), 0.5, 1e-12);
  EXPECT_NO_THROW(all->check_within(path_through({1.0, 0.0, 0.0})));
  EXPECT_THAT(
      [&] {
        some->check_within(path_through({1.0, 0.0, 0.0}));
      },
      ThrowsMessage<Error>(HasSubstr("within the region")));
}

}  // namespace
}  // namespace spinaltap
