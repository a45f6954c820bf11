// What undo leaves of holes in voxels: nothing.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/session/cutting_motion.h"
#include "core/session/record/session_record.h"
#include "tests/support/random_drilling.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_kind.h"
#include "tests/unit/vdb/sim/voxel_ball.h"
#include "vdb/sim/replay.h"

namespace spinaltap {
namespace {

using test::kEvenHu;
using test::kVoxelBall;
using test::occupancy_words;
using test::path_through;
using test::slot_of;
using test::slot_setup;
using test::voxel_ball;
using test::voxel_setup;
using testing::HasSubstr;
using testing::ThrowsMessage;

/// The slot of a hand that trembles and tilts.
std::vector<ToolInput> trembling_slot(const DrillPath& path, double aside_mm, std::uint64_t seed) {
  std::vector<ToolInput> inputs = slot_of(path, aside_mm);
  test::Random random(seed);
  Vec3 off_mm = Vec3::Zero();
  for (ToolInput& input : inputs) {
    off_mm = 0.9 * off_mm + 0.03 * random.direction();
    input.pose.tip_mm += off_mm;
    input.pose.axis = (input.pose.axis + 0.05 * off_mm).normalized();
  }
  return inputs;
}

/// Cycles and events of a hole, the voxels that it leaves, its display and the drilled bone: the same to the last bit.
struct VoxelHole {
  std::vector<RecordedCycle> rows;
  std::vector<std::size_t> event_cycles;
  std::vector<std::uint64_t> occupied;
  std::map<std::array<int, 3>, SurfaceBlock> shown;
  std::string drilled;
  bool operator==(const VoxelHole&) const = default;
};
VoxelHole run_hole(Session& session, const std::vector<ToolInput>& inputs,
                   std::map<std::array<int, 3>, SurfaceBlock>& shown) {
  VoxelHole hole;
  hole.rows = session.run(inputs);
  for (const SessionEvent& event : session.events()) hole.event_cycles.push_back(event.cycle);
  hole.occupied = occupancy_words(session);
  for (const SurfaceUpdate& update : session.surface_changes()) {
    shown.erase(update.block);
    if (update.surface) shown.emplace(update.block, *update.surface);
  }
  hole.shown = shown;
  hole.drilled = session.drilled().hash();
  return hole;
}

SLOW_TESTS("VoxelUndo.LeavesNoTraceOfWhatWasTakenBack");

TEST(VoxelUndo, LeavesNoTraceOfWhatWasTakenBack) {
  for (const bool has_region : {false, true}) {
    SCOPED_TRACE(has_region);
    SessionSetup setup = slot_setup(has_region ? std::optional(5.0) : std::nullopt);
    setup.engine = has_region ? EngineKind::automatic : EngineKind::voxel;
    setup.has_clearances = !has_region;
    const std::vector<ToolInput> taken_back = trembling_slot(setup.path, 4.0, 1),
                                 first = trembling_slot(setup.path, 2.0, 2),
                                 second = trembling_slot(setup.path, -3.0, 3);
    std::map<std::array<int, 3>, SurfaceBlock> shown, shown_again;
    Session plain(voxel_ball(), setup.path, setup), undone(voxel_ball(), setup.path, setup);
    const VoxelHole one = run_hole(plain, first, shown);
    const std::vector<std::uint64_t> whole = occupancy_words(undone);
    EXPECT_NE(one.occupied, whole);

    // What was drilled so far.
    run_hole(undone, taken_back, shown_again);
    EXPECT_TRUE(undone.undo());
    EXPECT_EQ(occupancy_words(undone), whole);
    EXPECT_TRUE(run_hole(undone, first, shown_again) == one);
    // A hole that is done, and half of one behind it.
    plain.end_hole();
    undone.end_hole();
    EXPECT_EQ(occupancy_words(undone), one.occupied);
    run_hole(undone, taken_back, shown_again);
    undone.end_hole();
    run_hole(undone, second, shown_again);
    EXPECT_TRUE(undone.undo());
    EXPECT_TRUE(undone.undo());
    EXPECT_EQ(occupancy_words(undone), one.occupied);
    EXPECT_EQ(undone.setup().holes.size(), 1U);
    const VoxelHole two = run_hole(plain, second, shown);
    EXPECT_TRUE(run_hole(undone, second, shown_again) == two);
    EXPECT_NE(two.rows.back(), one.rows.back());
    // All of it.
    EXPECT_TRUE(undone.undo());
    EXPECT_TRUE(undone.undo());
    EXPECT_EQ(occupancy_words(undone), whole);
    EXPECT_FALSE(undone.undo());
    EXPECT_EQ(undone.drilled().hash(), voxel_ball().hash());
  }
}

TEST(VoxelUndo, TakesBackHolesThatWereThereWhenTheSessionBegan) {
  const SessionSetup setup = slot_setup({});
  SessionSetup with_hole = setup;
  with_hole.holes = {hole_of(trembling_slot(setup.path, 4.0, 1), setup)};
  Session plain(voxel_ball(), setup.path, setup), begun(voxel_ball(), setup.path, with_hole);
  EXPECT_NE(occupancy_words(begun), occupancy_words(plain));
  begun.run(trembling_slot(setup.path, -3.0, 2));
  begun.end_hole();
  EXPECT_TRUE(begun.undo());
  EXPECT_TRUE(begun.undo());
  EXPECT_EQ(occupancy_words(begun), occupancy_words(plain));
  EXPECT_FALSE(begun.undo());
  const std::vector<ToolInput> inputs = trembling_slot(setup.path, 2.0, 3);
  EXPECT_EQ(begun.run(inputs), plain.run(inputs));
}

TEST(VoxelUndo, RecordsOfHolesBehindOthersReplayBitForBit) {
  const test::TemporaryFolder folder;
  const SessionSetup setup = slot_setup({});
  Session session(voxel_ball(), setup.path, setup);
  session.run(trembling_slot(setup.path, 4.0, 1));
  session.end_hole();
  session.run(trembling_slot(setup.path, 2.0, 2));
  session.undo();
  session.record(folder.path() / "second.h5");
  session.run(trembling_slot(setup.path, -3.0, 3));
  session.end_record();
  const Replay again = replay(folder.path() / "second.h5", voxel_ball());
  EXPECT_TRUE(again.is_same()) << again.difference;
  EXPECT_EQ(again.cycles, 401U);
}

TEST(VoxelUndo, AHoleThatLeavesNoBoneIsNotEnded) {
  const test::Ball small{kVoxelBall.centre_mm, 1.5};
  const Bone bone(test::bake_ball(small, 0.25, kEvenHu));
  SessionSetup setup = voxel_setup(path_through({0.0, 0.0, 1.0}, {6.0, 50.0, 1.0}));
  Session session(bone, setup.path, setup);
  std::vector<ToolInput> inputs;
  for (int n = 0; n <= 160; ++n) {
    inputs.push_back({{setup.path.entry_mm + 0.1 * n * setup.path.direction(), setup.path.direction()}, true, 1e-3});
  }
  const std::vector<RecordedCycle> rows = session.run(inputs);
  EXPECT_EQ(session.voxels()->occupied_count(), 0U);
  EXPECT_THAT([&] { session.end_hole(); }, ThrowsMessage<Error>(HasSubstr("all is drilled away")));
  EXPECT_EQ(session.last().index, 160U);
  EXPECT_EQ(session.voxels()->occupied_count(), 0U);
  EXPECT_TRUE(session.undo());
  EXPECT_EQ(session.run(inputs), rows);
}

}  // namespace
}  // namespace spinaltap
