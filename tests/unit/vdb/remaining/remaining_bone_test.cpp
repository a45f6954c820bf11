#include "vdb/remaining/remaining_bone.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <map>
#include <thread>

#include "core/base/error.h"
#include "tests/support/drilled_ball.h"
#include "vdb/remaining/surface_block.h"

namespace spinaltap {
namespace {

using test::ball_to_drill;
using test::Dice;
using test::kDrilledBall;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr double kDrilledVoxelMm = 0.4;

/// Every voxel's hole, in order.
std::vector<float> all_holes(const RemainingBone& bone) {
  std::vector<float> values;
  const auto low = bone.first_voxel();
  const auto high = bone.last_voxel();
  for (int x = low[0]; x <= high[0]; ++x) {
    for (int y = low[1]; y <= high[1]; ++y) {
      for (int z = low[2]; z <= high[2]; ++z) values.push_back(bone.hole_mm({x, y, z}));
    }
  }
  return values;
}

/// A burr somewhere in the ball; all are about as large.
void drill_somewhere(RemainingBone& bone, Dice& dice) {
  const Pose from{kDrilledBall.centre_mm + dice(2.0, 7.0) * dice.direction(), dice.direction()};
  const std::array way{from, Pose{from.tip_mm + dice.direction(), from.axis}};
  bone.drill(test::ball_burr(), way);
}

TEST(RemainingBone, UndoesAsManyHolesAsItsMemoryHolds) {
  constexpr std::size_t kBound = 400'000;
  Dice dice(1);
  RemainingBone bone(ball_to_drill(), {.voxel_mm = kDrilledVoxelMm, .undo_bytes = kBound});
  std::vector<std::vector<float>> moments{all_holes(bone)};
  for (int hole = 0; hole < 30; ++hole) {
    drill_somewhere(bone, dice);
    EXPECT_LE(bone.undo_memory_bytes(), kBound);
    bone.end_hole();
    EXPECT_LE(bone.undo_memory_bytes(), kBound);
    moments.push_back(all_holes(bone));
  }
  const std::size_t kept = bone.holes_to_undo();
  EXPECT_GT(kept, 2U);
  EXPECT_LT(kept, 30U);
  for (std::size_t n = 1; n <= kept; ++n) {
    ASSERT_TRUE(bone.undo());
    EXPECT_LE(bone.undo_memory_bytes(), kBound);
    ASSERT_EQ(all_holes(bone), moments[30 - n]);
    if (bone.holes_to_undo() == 0) break;
  }
  EXPECT_FALSE(bone.undo());
  // Blocks that were put back weigh other than those that were taken: not all of them may be left to redo.
  EXPECT_GT(bone.holes_to_redo(), 0U);
  while (bone.redo()) {
    EXPECT_LE(bone.undo_memory_bytes(), kBound);
  }
}

TEST(RemainingBone, MakesAHoleFinalThatIsTooLargeToKeep) {
  Dice dice(2);
  RemainingBone bone(ball_to_drill(), {.voxel_mm = kDrilledVoxelMm, .undo_bytes = 100'000});
  drill_somewhere(bone, dice);
  bone.end_hole();
  EXPECT_EQ(bone.holes_to_undo(), 1U);  // nothing was there before, so that nothing is kept but where
  for (int n = 0; n < 60; ++n) drill_somewhere(bone, dice);
  bone.end_hole();
  for (int n = 0; n < 60; ++n) drill_somewhere(bone, dice);
  EXPECT_LE(bone.undo_memory_bytes(), 100'000U);
  const std::vector<float> before = all_holes(bone);
  EXPECT_EQ(bone.holes_to_undo(), 0U);
  EXPECT_FALSE(bone.undo());
  EXPECT_EQ(all_holes(bone), before);
  // What follows is a hole like others, once that one has ended.
  bone.end_hole();
  const Pose outside{kDrilledBall.centre_mm + Vec3(0.0, 0.0, 9.5), -Vec3::UnitZ()};
  bone.drill({0.8, 5.0, 0.5}, {&outside, 1});
  EXPECT_TRUE(bone.undo());
  EXPECT_EQ(all_holes(bone), before);
}

TEST(RemainingBone, ForgetsWhatWasUndoneWhenItDrillsOn) {
  Dice dice(3);
  RemainingBone bone(ball_to_drill(), {.voxel_mm = kDrilledVoxelMm});
  drill_somewhere(bone, dice);
  bone.undo();
  EXPECT_EQ(bone.holes_to_redo(), 1U);
  drill_somewhere(bone, dice);
  EXPECT_EQ(bone.holes_to_redo(), 0U);
  EXPECT_FALSE(bone.redo());
  EXPECT_EQ(bone.holes_to_undo(), 1U);
}

TEST(RemainingBone, DrillsTheSameAfterUndoingAsBefore) {
  Dice dice(4);
  RemainingBone bone(ball_to_drill(), {.voxel_mm = kDrilledVoxelMm});
  drill_somewhere(bone, dice);
  bone.end_hole();
  const Dice again = dice;
  Dice first = again;
  for (int n = 0; n < 4; ++n) drill_somewhere(bone, first);
  const std::vector<float> drilled = all_holes(bone);
  bone.undo();
  Dice second = again;
  for (int n = 0; n < 4; ++n) drill_somewhere(bone, second);
  EXPECT_EQ(all_holes(bone), drilled);
  bone.reset();
  EXPECT_EQ(bone.holes_to_undo(), 0U);
  const std::vector<float> after_reset = all_holes(bone);
  EXPECT_TRUE(std::all_of(after_reset.begin(), after_reset.end(),
                          [&](float mm) { return static_cast<double>(mm) >= bone.band_mm(); }));
}

TEST(RemainingBone, RejectsWhatItCannotDrillAndStaysAsItWas) {
  EXPECT_THAT([] { RemainingBone(ball_to_drill(), {.voxel_mm = 0.0}); }, ThrowsMessage<Error>(HasSubstr("voxel")));
  EXPECT_THROW(RemainingBone(ball_to_drill(), {.voxel_mm = std::nan("")}), Error);
  EXPECT_THROW(RemainingBone(ball_to_drill(), {.voxel_mm = 1e-4}), Error);
  EXPECT_THROW(RemainingBone(ball_to_drill(), {.tolerance_voxels = 0.0}), Error);
  RemainingBone bone(ball_to_drill(), {.voxel_mm = kDrilledVoxelMm});
  const std::vector<float> before = all_holes(bone);
  const std::array good{Pose{kDrilledBall.centre_mm, Vec3::UnitZ()}, Pose{kDrilledBall.centre_mm, Vec3::UnitX()}};
  std::array bad = good;
  bad[1].axis *= 1.1;
  EXPECT_THAT([&] { bone.drill(test::paper_drill(), bad); }, ThrowsMessage<Error>(HasSubstr("axis")));
  bad = good;
  bad[1].tip_mm.x() = std::numeric_limits<double>::infinity();
  EXPECT_THROW(bone.drill(test::paper_drill(), bad), Error);
  EXPECT_THROW(bone.drill(test::paper_drill(), {}), Error);
  EXPECT_THROW(bone.drill({.diameter_mm = -1.0}, good), Error);
  EXPECT_EQ(all_holes(bone), before);
  EXPECT_EQ(bone.holes_to_undo(), 0U);
}

TEST(SurfaceFeed, LeadsAnotherThreadToTheSurfaceAsItIs) {
  Dice dice(5);
  RemainingBone bone(ball_to_drill(), {.voxel_mm = kDrilledVoxelMm});
  RemainingSurface surface(bone);
  using Shown = std::map<std::array<int, 3>, std::shared_ptr<const SurfaceBlock>>;
  Shown shown;
  for (const auto& block : surface.blocks()) shown[block->block] = block;
  SurfaceFeed feed;
  std::atomic<bool> is_done = false;
  std::size_t max_waiting = 0;
  std::thread display([&] {
    for (bool last = false; !last;) {
      last = is_done;
      const std::vector<SurfaceUpdate> updates = feed.take();
      max_waiting = std::max(max_waiting, updates.size());
      for (const SurfaceUpdate& update : updates) {
        if (update.surface == nullptr) {
          shown.erase(update.block);
        } else {
          shown[update.block] = update.surface;
        }
      }
    }
  });
  for (int n = 0; n < 60; ++n) {
    if (n % 5 == 4) {
      bone.undo();
    } else {
      drill_somewhere(bone, dice);
      bone.end_hole();
    }
    feed.give(surface.update());
  }
  is_done = true;
  display.join();
  std::vector<std::shared_ptr<const SurfaceBlock>> now;
  for (const auto& [place, block] : shown) now.push_back(block);
  EXPECT_EQ(now, surface.blocks());
  EXPECT_GT(max_waiting, 0U);
}

}  // namespace
}  // namespace spinaltap
