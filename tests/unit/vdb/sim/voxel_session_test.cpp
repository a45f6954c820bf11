// Sessions that drill the voxels of a whole bone: their forces against the model's of an even block, their records
// against their replays.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "core/base/error.h"
#include "core/session/operator/path_motion.h"
#include "core/session/record/session_record.h"
#include "tests/unit/vdb/sim/voxel_ball.h"
#include "vdb/engine/voxel_engine.h"
#include "vdb/sim/build_session.h"
#include "vdb/sim/drilling.h"
#include "vdb/sim/recorded_hole.h"
#include "vdb/sim/replay.h"
#include "vdb/sim/session_batch.h"

namespace spinaltap {
namespace {

using test::kEvenHu;
using test::kVoxelBall;
using test::path_through;
using test::section_of_voxels;
using test::voxel_ball;
using test::voxel_setup;
using testing::HasSubstr;
using testing::ThrowsMessage;

Drilling drill(const SessionSetup& setup, double step_mm = 0.02) {
  constexpr double kMmS = 1.0;
  PlannedMotion tool_operator(
      setup.path,
      {.line = {.lead_in_mm = setup.volume.lead_in_mm}, .rate_hz = kMmS / step_mm, .feed = {.steps = {{0.0, kMmS}}}});
  return drill_bone(voxel_ball(), setup, tool_operator, {.log_step_mm = 0.5});
}

/// Across the lattice, along it, and along its diagonals.
const std::vector<Vec3> kVoxelDirections{
    {0.2, -0.9, 0.3}, {0.0, 0.0, 1.0}, {-1.0, 0.0, 0.0}, {1.0, 1.0, 0.0}, {1.0, -1.0, 1.0}};

TEST(VoxelSessions, NeedTheThrustAndTorqueOfTheModelInEveryDirection) {
  const CuttingResistance even = resistance_of_block(path_through({1, 0, 0}).bit, Material(), kEvenHu);
  const double feed_mm = 60.0 / Spindle().rpm;
  for (const Vec3& direction : kVoxelDirections) {
    SCOPED_TRACE(testing::Message() << direction.transpose());
    const SessionSetup setup = voxel_setup(path_through(direction));
    const double section = section_of_voxels(setup.path, setup.volume.spacing_mm);
    EXPECT_NEAR(section, 1.0, 0.03);
    CuttingResistance expected = even;
    expected.lips_n *= section;
    expected.lips_n_mm *= section;
    double thrust_n = 0.0, torque_n_mm = 0.0;
    int rows = 0;
    const Drilling drilling = drill(setup);
    for (const DepthRow& row : drilling.rows) {
      if (row.depth_mm < 4.5 || row.depth_mm > 13.6) continue;  // the whole cone is in
      ++rows;
      thrust_n += row.thrust_n;
      torque_n_mm += row.torque_n_mm;
      EXPECT_NEAR(row.thrust_n, even.thrust_n(feed_mm), 0.05 * even.thrust_n(feed_mm)) << row.depth_mm;
      EXPECT_NEAR(row.hu, kEvenHu, 1e-9);
    }
    ASSERT_GT(rows, 15);
    EXPECT_NEAR(thrust_n / rows, expected.thrust_n(feed_mm), 0.01 * even.thrust_n(feed_mm));
    EXPECT_NEAR(torque_n_mm / rows, expected.torque_n_mm(feed_mm), 0.01 * even.torque_n_mm(feed_mm));
  }
}

TEST(VoxelSessions, RemoveTheVolumeOfTheHole) {
  const DrillPath path = path_through({0.2, -0.9, 0.3});
  const Drilling drilling = drill(voxel_setup(path));
  const double r = path.bit.radius_mm();
  const double cap_mm = kVoxelBall.radius_mm - std::sqrt(kVoxelBall.radius_mm * kVoxelBall.radius_mm - r * r);
  const double hole_mm3 =
      std::numbers::pi * r * r * (14.0 - path.bit.tip_length_mm * 2.0 / 3.0) - std::numbers::pi * r * r * cap_mm / 2.0;
  EXPECT_NEAR(1e-3 * static_cast<double>(drilling.removed), hole_mm3, 0.01 * hole_mm3);
  EXPECT_NEAR(1e-3 * static_cast<double>(drilling.points_in_bone), 4.0 / 3.0 * std::numbers::pi * std::pow(9.0, 3),
              0.005 * 4.0 / 3.0 * std::numbers::pi * std::pow(9.0, 3));
  ASSERT_TRUE(drilling.left.voxels);
  EXPECT_EQ(drilling.left.voxels->occupied_count() + drilling.removed, drilling.points_in_bone);
  EXPECT_EQ(drilling.discs, 0);
  // The cone's tip holds a voxel's volume, and with luck a voxel, from 0.15 mm on.
  EXPECT_NEAR(drilling.entry_depth_mm, 0.15, 0.1);
  EXPECT_TRUE(std::ranges::any_of(drilling.events, [](const SessionEvent& event) {
    return event.kind == EventKind::contact && std::abs(event.depth_mm - 0.15) < 0.1;
  }));
}

TEST(VoxelSessions, ForcesOfABurrThatGoesSidewaysDoTheWorkOfWhatItCuts) {
  const Material material;
  VoxelBone bone(voxel_ball().model());
  const DrillBit burr{4.0, 40.0, 1.0, BitShape::round_burr, 0.0, 2.0};
  const auto engine = make_voxel_engine(bone, burr, material);
  const auto occupied = make_occupied_bone(bone, material);
  DrillForces forces(*occupied, burr, material);
  const Spindle spindle{10'000.0, true};
  constexpr double kStepMm = 0.02, kStepS = 1e-3;
  double torque_work = 0.0, removed_mm3 = 0.0, removed_n_mm = 0.0;
  for (int n = 0; n < 900; ++n) {
    const Pose pose{kVoxelBall.centre_mm + Vec3(-9.0 - 3.0 + n * kStepMm, 0.0, -7.5), -Vec3::UnitZ()};
    const StepResult step = engine->step(pose);
    const DrillForce force = forces.update(step, pose, kStepS, spindle);
    ASSERT_TRUE(force.force_n.allFinite());
    removed_mm3 += step.removed_mm3;
    removed_n_mm += step.work_n_mm;
    const double turned = 2.0 * std::numbers::pi * spindle.rpm / 60.0 * kStepS;
    torque_work += force.torque_n_mm * turned;
  }
  ASSERT_GT(removed_mm3, 20.0);
  // Thin chips cost more: by the feed per turn to minus the exponent.
  const double feed_mm = kStepMm / kStepS / (spindle.rpm / 60.0);
  const double expected = removed_n_mm * std::pow(feed_mm / material.reference_feed_mm, -material.feed_exponent);
  EXPECT_NEAR(torque_work, expected, 0.02 * expected);
}

TEST(VoxelSessions, ABitAtRestInBoneIsPushedBackAsByPoints) {
  const DrillPath path = path_through({0.0, 0.0, 1.0});
  for (const double depth_mm : {1.0, 2.5}) {
    double contact_n[2];
    for (const EngineKind kind : {EngineKind::ring, EngineKind::voxel}) {
      SessionSetup setup = voxel_setup(path);
      setup.engine = kind;
      const BuiltSession built = build_session(voxel_ball(), setup);
      ToolInput input;
      input.pose = {path.entry_mm + depth_mm * path.direction(), path.direction()};
      input.spindle_on = false;
      contact_n[kind == EngineKind::voxel] = built.session->step(input).force.contact_n.norm();
    }
    EXPECT_GT(contact_n[0], 1.0);
    EXPECT_NEAR(contact_n[1], contact_n[0], 0.05 * contact_n[0]) << depth_mm;
  }
}

TEST(VoxelSessions, RecordsReplayBitForBitAndHolesBeforeAreGone) {
  SessionSetup setup = voxel_setup(path_through({0.2, -0.9, 0.3}));
  const DrillPath before = path_through({1.0, 0.1, 0.0});
  setup.holes.push_back(
      {before.bit, {{{before.entry_mm, before.direction()}, {before.target_mm, before.direction()}}}});
  setup.bone_hash = voxel_ball().hash();
  SessionRecord record;
  std::size_t removed = 0;
  {
    const BuiltSession built = build_session(voxel_ball(), setup);
    PlannedMotion tool_operator(setup.path,
                                {.line = {.lead_in_mm = 1.0}, .rate_hz = 200.0, .feed = {.steps = {{0.0, 2.0}}}});
    run_session(*built.session, tool_operator, [&](const Cycle& cycle) {
      record.cycles.push_back(recorded(cycle));
      removed += cycle.step.removed;
    });
    record.events.assign(built.session->events().begin(), built.session->events().end());
    record.is_whole = true;
  }
  ASSERT_GT(removed, 10'000U);
  EXPECT_LT(removed, drill(voxel_setup(setup.path)).removed) << "the holes cross";
  const BuiltSession again = build_session(voxel_ball(), setup);
  const Replay same = replay_record(*again.session, record);
  EXPECT_EQ(same.difference, "");
  EXPECT_EQ(same.cycles, record.cycles.size());
  SessionSetup by_points = setup;
  by_points.engine = EngineKind::ring;
  const BuiltSession other = build_session(voxel_ball(), by_points);
  EXPECT_NE(replay_record(*other.session, record).difference, "") << "points are not voxels";
}

TEST(VoxelSessions, ABatchBeginsAgainWithAllBone) {
  SessionSetup setup = voxel_setup(path_through({0.2, -0.9, 0.3}));
  SessionBatch batch({{voxel_ball(), setup.path}}, 2, setup);
  const auto run = [&](std::size_t n) {
    std::vector<double> thrust_n;
    PlannedMotion tool_operator(setup.path,
                                {.line = {.lead_in_mm = 1.0}, .rate_hz = 50.0, .feed = {.steps = {{0.0, 2.0}}}});
    run_session(batch.session(n), tool_operator, [&](const Cycle& cycle) { thrust_n.push_back(cycle.force.thrust_n); });
    return thrust_n;
  };
  const std::vector<double> first = run(0);
  EXPECT_EQ(run(1), first) << "each has voxels of its own";
  batch.reset(0);
  EXPECT_EQ(run(0), first);
}

TEST(VoxelSessions, RejectWhatOnlyPointsHave) {
  const auto rejects = [](const std::function<void(SessionSetup&)>& change, const char* words) {
    SessionSetup setup = voxel_setup(path_through({1.0, 0.0, 0.0}));
    change(setup);
    EXPECT_THAT([&] { build_session(voxel_ball(), setup); }, ThrowsMessage<Error>(HasSubstr(words)));
  };
  rejects([](SessionSetup& setup) { setup.volume.jitter = 0.2; }, "expected no jitter");
  rejects([](SessionSetup& setup) { setup.fine_spacing_mm = 0.05; }, "expected no finer spacing");
  rejects([](SessionSetup& setup) { setup.volume.subdivision = DiscSubdivision::hexagons; }, "expected no other");
  rejects([](SessionSetup& setup) { setup.volume.spacing_mm = 0.001; }, "expected a size");
}

}  // namespace
}  // namespace spinaltap
