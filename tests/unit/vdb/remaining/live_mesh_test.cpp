#include "vdb/remaining/live_mesh.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "mesh/mesh_quality.h"
#include "mesh/remaining_mesh.h"
#include "tests/support/drilled_ball.h"

namespace spinaltap {
namespace {

using test::ball_to_drill;
using test::kDrilledBall;

constexpr double kLongestJumpMm = 5.0;

/// A cylinder that fits into the ball, but for a tip of 0.1 mm.
DrillBit short_bit() { return {3.0, 4.0, 0.1}; }

MeshQuality quality(const LiveMesh& live) { return measure_mesh(join_blocks(live.surface().blocks())); }

ToolInput at(double x_mm, double y_mm = 0.0) {
  return {{kDrilledBall.centre_mm + Vec3(x_mm, y_mm, 2.0), Vec3::UnitZ()}};
}

TEST(LiveMesh, TakesWhatTheBitSweptOnItsWay) {
  LiveMesh live(ball_to_drill(), short_bit(), kLongestJumpMm);
  const double whole_mm3 = quality(live).volume_mm3;
  EXPECT_NEAR(whole_mm3, kDrilledBall.volume_mm3(), 1e-3 * kDrilledBall.volume_mm3());
  live.update(at(-2.0));
  EXPECT_FALSE(live.updates().empty());
  live.update(at(2.0));
  // A slot: a cylinder and a box of the way's length. The tip's cone lacks two thirds of its height.
  const double slot_mm3 = (4.0 - 0.07) * (std::numbers::pi * 1.5 * 1.5 + 4.0 * 3.0);
  const MeshQuality drilled = quality(live);
  EXPECT_TRUE(drilled.closed());
  EXPECT_NEAR(whole_mm3 - drilled.volume_mm3, slot_mm3, 0.01 * slot_mm3);
}

TEST(LiveMesh, TakesNothingWithTheSpindleOffOnJumpsAndAtPosesThatAreNone) {
  LiveMesh live(ball_to_drill(), short_bit(), kLongestJumpMm);
  const double whole_mm3 = quality(live).volume_mm3;
  ToolInput off = at(0.0);
  off.spindle_on = false;
  live.update(off);
  ToolInput no_pose = at(0.0);
  no_pose.pose.tip_mm.x() = std::numeric_limits<double>::quiet_NaN();
  live.update(no_pose);
  EXPECT_EQ(quality(live).volume_mm3, whole_mm3);
  // Two bits that stand, and nothing between.
  live.update(at(-3.0));
  live.update(at(3.0));
  const double two_mm3 = 2.0 * (4.0 - 0.07) * std::numbers::pi * 1.5 * 1.5;
  EXPECT_NEAR(whole_mm3 - quality(live).volume_mm3, two_mm3, 0.01 * two_mm3);
  EXPECT_FALSE(live.updates().empty());
  live.update(at(3.0));
  EXPECT_TRUE(live.updates().empty());
}

TEST(LiveMesh, UndoesAndRedoesWholeHoles) {
  LiveMesh live(ball_to_drill());
  EXPECT_FALSE(live.undo_hole());
  LiveMesh keeping(ball_to_drill(), {.voxel_mm = 0.4});
  const double whole_mm3 = quality(keeping).volume_mm3;
  keeping.take_bit(short_bit(), kLongestJumpMm);
  const std::array<ToolInput, 3> way{at(-2.0), at(0.0), at(2.0)};
  keeping.update(way);
  keeping.end_hole();
  const double one_hole_mm3 = quality(keeping).volume_mm3;
  EXPECT_LT(one_hole_mm3, whole_mm3 - 10.0);
  keeping.take_bit(short_bit(), kLongestJumpMm);
  keeping.update(at(0.0, 3.0));
  EXPECT_EQ(keeping.holes_to_undo(), 2U);
  const double two_holes_mm3 = quality(keeping).volume_mm3;
  EXPECT_TRUE(keeping.undo_hole());
  EXPECT_FALSE(keeping.updates().empty());
  EXPECT_EQ(quality(keeping).volume_mm3, one_hole_mm3);
  EXPECT_TRUE(keeping.undo_hole());
  EXPECT_EQ(quality(keeping).volume_mm3, whole_mm3);
  EXPECT_TRUE(keeping.redo_hole());
  EXPECT_TRUE(keeping.redo_hole());
  EXPECT_EQ(quality(keeping).volume_mm3, two_holes_mm3);
  keeping.reset();
  EXPECT_EQ(quality(keeping).volume_mm3, whole_mm3);
}

}  // namespace
}  // namespace spinaltap
