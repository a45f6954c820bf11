#include "core/force/detail/wall_support.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/points/bone_points.h"
#include "tests/unit/core/force/felt_run.h"

namespace spinaltap {
namespace {

const DrillBit kDrill = twist_drill(3.0, 40.0, 118.0, 0.48);
constexpr double kDeepMm = 20.0;

class WallSupportInABlock : public ::testing::Test {
 protected:
  WallSupportInABlock() : volume_(test::block(30.0, 4.0, 0.2, test::kFeltHu)), bone_({&volume_, 1}, Material{}) {}

  /// At a depth along the block, in the bone's coordinates.
  static Pose at(double depth_mm) { return {Vec3(0.0, 0.0, depth_mm), Vec3::UnitZ()}; }
  /// Of the lands that lie in the block: half their wall's stiffness, each place by its cosine squared.
  static double stiffness_n_mm(double lands_mm) {
    const double radius_mm = 1.5;
    return Material().contact_stiffness_n_mm(test::kFeltHu) * 0.5 * std::numbers::pi * radius_mm * lands_mm /
           (std::numbers::pi * radius_mm * radius_mm);
  }

  PointVolume volume_;
  BonePoints bone_;
};

TEST_F(WallSupportInABlock, HoldsAPushAtOnceByItsWallsStiffness) {
  for (const Vec3& push_mm : {Vec3(0.01, 0.0, 0.0), Vec3(-0.02, 0.03, 0.0), Vec3(0.0, -0.01, 5.0)}) {
    WallSupport wall(bone_, kDrill);
    const Vec3 force_n = wall.force_n(at(kDeepMm), push_mm, Vec3::Zero(), 0.0);
    const Vec3 across_mm(push_mm.x(), push_mm.y(), 0.0);
    // From its lips to the block's begin, to one ring of 2 mm.
    const double held_n = stiffness_n_mm(kDeepMm - kDrill.tip_length_mm) * across_mm.norm();
    EXPECT_NEAR(force_n.norm(), held_n, 0.06 * held_n);
    EXPECT_NEAR(force_n.normalized().dot(across_mm.normalized()), -1.0, 1e-6) << "against the push";
  }
}

TEST_F(WallSupportInABlock, GivesWayWithinATurn) {
  WallSupport wall(bone_, kDrill);
  const double first_n = wall.force_n(at(kDeepMm), Vec3(0.01, 0.0, 0.0), Vec3::Zero(), 0.0).norm();
  constexpr double kTurns = 1e-3;
  double force_n = 0.0;
  for (int n = 0; n < 1000; ++n) force_n = wall.force_n(at(kDeepMm), Vec3::Zero(), Vec3::Zero(), kTurns).norm();
  EXPECT_NEAR(force_n, first_n * std::exp(-1.0), 0.01 * first_n);
  // Pushed on and on, it is held by what it is pressed in a turn.
  for (int n = 0; n < 20'000; ++n) {
    force_n = wall.force_n(at(kDeepMm), Vec3(0.02 * kTurns, 0.0, 0.0), Vec3::Zero(), kTurns).norm();
  }
  EXPECT_NEAR(force_n, 2.0 * first_n, 0.01 * first_n);
}

TEST_F(WallSupportInABlock, IsTheMoreTheDeeperTheHole) {
  double before_n = 0.0;
  for (const double depth_mm : {6.0, 12.0, 18.0, 24.0}) {
    WallSupport wall(bone_, kDrill);
    const double force_n = wall.force_n(at(depth_mm), Vec3(0.01, 0.0, 0.0), Vec3::Zero(), 0.0).norm();
    EXPECT_GT(force_n, before_n);
    before_n = force_n;
  }
}

TEST_F(WallSupportInABlock, TurnedAboutTheMiddleOfItsHoleIsHeldTooButNotPushed) {
  WallSupport wall(bone_, kDrill);
  // About 10 mm behind the tip: the lands in bone lie 1 to 20 mm behind it, nearly evenly about that.
  const double turn = 1e-3;
  const Vec3 force_n = wall.force_n(at(kDeepMm), Vec3(10.0 * turn, 0.0, 0.0), Vec3(turn, 0.0, 0.0), 0.0);
  WallSupport pushed(bone_, kDrill);
  const double held_n = pushed.force_n(at(kDeepMm), Vec3(10.0 * turn, 0.0, 0.0), Vec3::Zero(), 0.0).norm();
  EXPECT_LT(force_n.norm(), 0.15 * held_n);
}

TEST_F(WallSupportInABlock, ToolsThatCutWithTheirSidesHaveNone) {
  WallSupport wall(bone_, {3.0, 40.0, 1.0, BitShape::round_burr, 0.0, 1.5});
  EXPECT_EQ(wall.force_n(at(kDeepMm), Vec3(0.01, 0.0, 0.0), Vec3::Zero(), 0.0), Vec3::Zero());
}

}  // namespace
}  // namespace spinaltap
