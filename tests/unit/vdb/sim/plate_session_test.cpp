// Sessions of saws and osteotomes: forces against the energy of what they cut, the session's rules for sides.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "core/session/choose_engine.h"
#include "core/session/operator/path_motion.h"
#include "tests/support/analytic_bodies.h"
#include "tests/support/release_only.h"
#include "vdb/engine/occupied_voxels.h"
#include "vdb/engine/voxel_engine.h"
#include "vdb/sim/drilling.h"
#include "vdb/sim/session.h"

namespace spinaltap {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr std::int16_t kSawnHu = 304;  // eight bits have it
const test::Ball kSawnBall{Vec3(3.0, -4.0, 5.0), 9.0};
const DrillBit kSessionSaw = plate_bit(6.0, 1.0, 30.0, 3.0);
const DrillBit kOsteotome = plate_bit(6.0, 1.0, 30.0);

const Bone& sawn_ball() {
  static const Bone bone(test::bake_ball(kSawnBall, 0.25, kSawnHu));
  return bone;
}

/// What a plate that goes through the ball feels, and what it took.
struct Sawing {
  double thrust_way_n_mm = 0.0;   ///< thrust along the way down
  double lateral_way_n_mm = 0.0;  ///< lateral force along the way aside
  double removed_n_mm = 0.0;      ///< energy of what it cut, at the reference feed
  double most_torque_n_mm = 0.0;
  double thrust_in_the_middle_n = 0.0;
};

Sawing saw(const DrillBit& bit, const Spindle& spindle, double step_mm, bool aside) {
  const Material material;
  VoxelBone bone(sawn_ball().model());
  const auto engine = make_voxel_engine(bone, bit, material);
  const auto occupied = make_occupied_bone(bone, material);
  DrillForces forces(*occupied, bit, material);
  const Vec3 axis = Vec3(0.2, -0.9, 0.3).normalized();
  const Vec3 side = any_perpendicular(axis);
  const Vec3 across = axis.cross(side);
  const Vec3 way = aside ? across : axis;
  const Vec3 start =
      aside ? Vec3(kSawnBall.centre_mm - 12.0 * across + 4.0 * axis) : Vec3(kSawnBall.centre_mm - 11.0 * axis);
  Sawing sawing;
  const int steps = static_cast<int>((aside ? 24.0 : 11.0) / step_mm);
  for (int n = 0; n < steps; ++n) {
    const Pose pose{start + n * step_mm * way, axis, side};
    const StepResult step = engine->step(pose);
    const DrillForce force = forces.update(step, pose, 1e-3, spindle);
    EXPECT_TRUE(force.force_n.allFinite());
    sawing.thrust_way_n_mm -= force.force_n.dot(axis) * (aside ? 0.0 : step_mm);
    sawing.lateral_way_n_mm -= force.force_n.dot(across) * (aside ? step_mm : 0.0);
    sawing.removed_n_mm += step.work_n_mm;
    sawing.most_torque_n_mm = std::max(sawing.most_torque_n_mm, std::abs(force.torque_n_mm));
    if (n == steps * 3 / 4) sawing.thrust_in_the_middle_n = force.thrust_n;
  }
  return sawing;
}

TEST(PlateForces, OfASawDoTheShareOfTheEnergyThatTheHandGives) {
  RELEASE_ONLY();
  // The teeth go 2 strokes' lengths in a stroke, the hand one feed: of the energy of what dies the motor gives nearly
  // all. What the hand presses with is the lips' share of the force along the cut.
  const Material material;
  for (const double strokes_per_min : {6000.0, 14000.0}) {
    const Spindle spindle{strokes_per_min, true};
    constexpr double kStepMm = 0.005;  // 5 mm/s
    const double feed_mm = kStepMm / 1e-3 / (strokes_per_min / 60.0);
    const double dear = std::pow(feed_mm / material.reference_feed_mm, -material.feed_exponent);
    const double share = material.lip_thrust_share * feed_mm / (2.0 * kSessionSaw.stroke_mm);
    for (const bool aside : {false, true}) {
      SCOPED_TRACE(testing::Message() << strokes_per_min << (aside ? " aside" : " down"));
      const Sawing sawing = saw(kSessionSaw, spindle, kStepMm, aside);
      ASSERT_GT(sawing.removed_n_mm, 100.0);
      const double expected = share * dear * sawing.removed_n_mm;
      EXPECT_NEAR(aside ? sawing.lateral_way_n_mm : sawing.thrust_way_n_mm, expected, 0.03 * expected);
      EXPECT_EQ(sawing.most_torque_n_mm, 0.0);
    }
  }
}

TEST(PlateForces, OfAnOsteotomeArePressureOfItsEdgeOnBone) {
  const Sawing driven = saw(kOsteotome, Spindle{}, 0.02, false);
  const double expected_n = Material().chisel_pressure_mpa(kSawnHu) * 6.0 * 1.0;
  EXPECT_NEAR(driven.thrust_in_the_middle_n, expected_n, 0.05 * expected_n);
  // Driven aside it takes all of the energy from the hand.
  const Sawing aside = saw(kOsteotome, Spindle{}, 0.02, true);
  EXPECT_NEAR(aside.lateral_way_n_mm, aside.removed_n_mm, 0.03 * aside.removed_n_mm);
}

SessionSetup plate_setup(const DrillBit& bit) {
  SessionSetup setup;
  // Its faces lie along no layers of voxels that are far between.
  const Vec3 axis = Vec3(0.213, -0.887, 0.31).normalized();
  const Vec3 entry_mm = kSawnBall.centre_mm - kSawnBall.radius_mm * axis;
  setup.path = {"cut", entry_mm, entry_mm + 12.0 * axis, bit};
  setup.engine = EngineKind::voxel;
  setup.volume.spacing_mm = 0.1;
  setup.volume.lead_in_mm = 1.0;
  setup.has_clearances = false;
  return setup;
}

Drilling drill_plate(const SessionSetup& setup) {
  PlannedMotion tool_operator(setup.path,
                              {.line = {.lead_in_mm = 1.0}, .rate_hz = 100.0, .feed = {.steps = {{0.0, 5.0}}}});
  return drill_bone(sawn_ball(), setup, tool_operator, {.log_step_mm = 0.5});
}

TEST(PlateSessions, CutTheirKerfWithOperatorsThatSayNoSide) {
  SessionSetup setup = plate_setup(kSessionSaw);
  const Drilling headwards = drill_plate(setup);
  // Box less the ball's cap over it: the cap's depth over the section is the mean of (x² + y²) / 2 R.
  const double cap_mm = (36.0 / 12.0 + 1.0 / 12.0) / (2.0 * kSawnBall.radius_mm);
  const double kerf_mm3 = 6.0 * 1.0 * (12.0 - cap_mm);
  EXPECT_NEAR(1e-3 * static_cast<double>(headwards.removed), kerf_mm3, 5e-3 * kerf_mm3);
  ASSERT_TRUE(headwards.left.voxels);
  const Vec3 deep_mm = setup.path.entry_mm + 8.0 * setup.path.direction();
  const auto lives_at = [](const Drilling& drilling, const Vec3& p_mm) {
    return drilling.left.voxels->is_occupied((p_mm / 0.1).array().round().matrix().cast<int>());
  };
  // Its width lies headwards, as nearly as the path lets it: there bone is gone 2.8 mm off the path, and 2.8 mm across
  // that it lives.
  const Vec3 axis = setup.path.direction();
  const Vec3 head = (Vec3::UnitZ() - axis.z() * axis).normalized();
  EXPECT_FALSE(lives_at(headwards, deep_mm + 2.8 * head));
  EXPECT_TRUE(lives_at(headwards, deep_mm + 2.8 * axis.cross(head)));
  setup.path.bit.width_along = Vec3::UnitX();
  const Drilling aside = drill_plate(setup);
  EXPECT_TRUE(lives_at(aside, deep_mm + 2.8 * head));
}

TEST(PlateSessions, RejectPosesThatDoNotTellHowThePlateIsHeld) {
  const BuiltSession built = build_session(sawn_ball(), plate_setup(kSessionSaw));
  ToolInput input;
  input.pose = {kSawnBall.centre_mm, Vec3::UnitZ()};  // along the width's own direction
  EXPECT_EQ(built.session->step(input).step.removed, 0U);
  ASSERT_FALSE(built.session->events().empty());
  EXPECT_EQ(built.session->events().front().kind, EventKind::invalid_pose);
  input.pose.side = Vec3::UnitX();
  EXPECT_GT(built.session->step(input).step.removed, 0U);
}

TEST(PlateSessions, AreOfVoxelsOnly) {
  SessionSetup setup = plate_setup(kSessionSaw);
  setup.engine = EngineKind::automatic;
  EXPECT_EQ(chosen_engine(setup), EngineKind::voxel);
  for (const EngineKind kind : {EngineKind::ring, EngineKind::leaf, EngineKind::reference, EngineKind::arc}) {
    setup.engine = kind;
    EXPECT_THAT([&] { build_session(sawn_ball(), setup); }, ThrowsMessage<Error>(HasSubstr("plate")));
  }
}

TEST(PlateSessions, APlateAtRestInBoneIsPushedBackAndAnEvenPressFromAllSidesCancels) {
  const SessionSetup setup = plate_setup(kOsteotome);
  ToolInput input;
  input.spindle_on = false;
  const Vec3 axis = setup.path.direction();
  const auto contact_at = [&](double depth_mm) -> Vec3 {
    const BuiltSession built = build_session(sawn_ball(), setup);
    input.pose = {setup.path.entry_mm + depth_mm * axis, axis};
    return built.session->step(input).force.contact_n;
  };
  EXPECT_EQ(contact_at(-2.0), Vec3::Zero());
  const Vec3 shallow = contact_at(1.5), deep = contact_at(3.0);
  // Pressed out, along its axis; on both large faces alike.
  EXPECT_LT(shallow.dot(axis), -1.0);
  EXPECT_LT(deep.dot(axis), shallow.dot(axis));
  EXPECT_LT((deep - deep.dot(axis) * axis).norm(), 0.15 * deep.norm());
}

}  // namespace
}  // namespace spinaltap
