#include "vdb/sim/session.h"
#include "vdb/sim/recorded_hole.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/session/operator/motion_log.h"
#include "core/session/operator/path_motion.h"
#include "core/session/operator/recorded_motion.h"
#include "core/session/record/session_record.h"
#include "tests/support/count_allocations.h"
#include "tests/support/memory_used.h"
#include "tests/unit/vdb/sim/session_ball.h"
#include "vdb/sim/build_session.h"

namespace spinaltap {
namespace {

using test::session_ball::ball;
using test::session_ball::kSessionBall;
using test::session_ball::path;
using test::session_ball::setup;
using test::session_ball::straight_in;
using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(Session, GivesWhatADrillSessionGives) {
  SessionSetup whole = setup();
  whole.path = path();
  const BuiltSession built = build_session(ball(), whole);
  Session session(ball(), path(), setup());
  double work_n_mm = 0.0;
  for (const ToolInput& input : straight_in(400)) {
    const RecordedCycle expected = recorded(built.session->step(input));
    EXPECT_EQ(recorded(session.step(input.pose, input.dt_s)), expected);
    work_n_mm += session.last().step.work_n_mm;
  }
  EXPECT_GT(work_n_mm, 0.0);
  EXPECT_EQ(session.events().size(), built.session->events().size());
}

TEST(Session, GivesTheSameForManyPosesAtOnceAndForAnOperator) {
  const std::vector<ToolInput> inputs = straight_in(300);
  Session one(ball(), path(), setup()), many(ball(), path(), setup()), led(ball(), path(), setup());
  std::vector<RecordedCycle> rows, of_operator;
  for (const ToolInput& input : inputs) rows.push_back(recorded(one.step_input(input)));
  RecordedMotion tool_operator(inputs);
  led.run(tool_operator, [&](const Cycle& cycle) { of_operator.push_back(recorded(cycle)); });
  EXPECT_EQ(many.run(inputs), rows);
  EXPECT_EQ(of_operator, rows);
}

TEST(Session, OutlivesTheBoneAndThePathItWasMadeFrom) {
  std::unique_ptr<Session> session;
  {
    const Bone bone(test::bake_ball(kSessionBall, 0.3));
    const DrillPath line = path();
    session = std::make_unique<Session>(bone, line, setup());
  }
  Session moved = std::move(*session);
  session.reset();
  EXPECT_GT(moved.run(straight_in(300)).back().thrust_n, 0.0);
}

// A hand leaves the path, and with it the cylinder of points: it used to go through all bone beside it as through air.
TEST(Session, WithADeviceDrillsBesideThePathAsVoxelsDo) {
  SessionSetup device = setup(), voxels = setup();
  device.options.has_device = true;
  voxels.options.has_device = true;
  voxels.engine = EngineKind::voxel;
  for (const double aside_mm : {0.0, 4.0, 6.0}) {
    Session at_device(ball(), path(), device), in_voxels(ball(), path(), voxels);
    EXPECT_EQ(at_device.setup().engine, EngineKind::voxel);
    const std::vector<RecordedCycle> rows = at_device.run(straight_in(500, aside_mm));
    EXPECT_EQ(rows, in_voxels.run(straight_in(500, aside_mm))) << aside_mm;
    EXPECT_GT(std::ranges::max(rows, {}, &RecordedCycle::thrust_n).thrust_n, 1.0) << aside_mm;
    EXPECT_EQ(at_device.events().size(), in_voxels.events().size());
    EXPECT_TRUE(std::ranges::count(at_device.events(), EventKind::contact, &SessionEvent::kind) == 1) << aside_mm;
  }
}

TEST(Session, TakesNoPointsForADevice) {
  SessionSetup device = setup();
  device.options.has_device = true;
  device.engine = EngineKind::ring;
  EXPECT_THAT([&] { Session(ball(), path(), device); },
              ThrowsMessage<Error>(HasSubstr("a device: expected the engine voxel, found ring")));
}

TEST(Session, SaysWhereAHandGoesThroughBoneThatItsPointsDoNotHold) {
  for (const bool has_clearances : {false, true}) {
    SessionSetup points = setup();
    points.has_clearances = has_clearances;
    Session session(ball(), path(), points);
    const std::vector<RecordedCycle> rows = session.run(straight_in(500, 5.0));
    EXPECT_EQ(std::ranges::max(rows, {}, &RecordedCycle::thrust_n).thrust_n, 0.0);
    const auto event = std::ranges::find(session.events(), EventKind::outside_volume, &SessionEvent::kind);
    ASSERT_NE(event, session.events().end()) << has_clearances;
    EXPECT_NEAR(event->value, 5.0 - 2.0, 0.15);
  }
}

TEST(Session, SaysNothingOfAHandInTheAirBesideThePath) {
  Session session(ball(), path(), setup());
  session.run(straight_in(50, 7.0));  // before the entry's depth
  EXPECT_TRUE(session.events().empty());
}

// A hand at a burr for as long as it takes to fill the memory that a hole has, and longer.
TEST(Session, StepsAllocateNothingAndMemoryStaysAtAnyLength) {
  constexpr std::size_t kCycles = 330'000;
  static_assert(kCycles > MotionLog::kExact);
  SessionSetup free = setup();
  free.engine = EngineKind::voxel;
  free.options.follows_path = false;
  free.volume.spacing_mm = 0.4;
  DrillPath burred = path();
  burred.bit = {3.0, 50.0, 2.0, BitShape::round_burr, 0.0, 2.0};
  Session session(ball(), burred, free);
  const Tremor tremor(0.1, 3);
  const auto input = [&](std::size_t n) {
    const double time_s = 0.001 * static_cast<double>(n);
    const Vec3 slow_mm(5.0 * std::sin(0.31 * time_s), 4.0 * std::cos(0.17 * time_s), 4.0 * std::sin(0.05 * time_s));
    return ToolInput{{kSessionBall.centre_mm + slow_mm + tremor.at_mm(time_s), -Vec3::UnitZ()}, true, 0.001};
  };
  const std::size_t occupied = session.voxels()->occupied_count();
  const std::size_t memory_bytes = test::resident_bytes(), allocations = test::allocation_count();
  for (std::size_t n = 0; n < kCycles; ++n) session.step_input(input(n));
  EXPECT_EQ(test::allocation_count(), allocations);
#ifndef SPINALTAP_INSTRUMENTED  // sanitizers have memory of their own
  EXPECT_LT(static_cast<double>(test::resident_bytes()) - static_cast<double>(memory_bytes), 22e6);
#endif
  EXPECT_GT(session.motion_off_mm(), 0.0);
  EXPECT_LT(session.motion_off_mm(), 0.01);
  const std::size_t left = session.voxels()->occupied_count();
  EXPECT_LT(left, occupied);

  // The hole that is kept takes the same voxels, but for those that its ways pass by less than they are off.
  session.end_hole();
  EXPECT_NEAR(static_cast<double>(session.voxels()->occupied_count()), static_cast<double>(left),
              0.002 * static_cast<double>(occupied - left));
  EXPECT_EQ(session.motion_off_mm(), 0.0);
  session.run(std::vector{input(0), input(1)});
  EXPECT_TRUE(session.undo());
  EXPECT_TRUE(session.undo());
  EXPECT_EQ(session.voxels()->occupied_count(), occupied);
}

TEST(Session, RejectsAPathThatMissesTheBone) {
  DrillPath beside = path();
  beside.entry_mm.x() += 50.0;
  beside.target_mm.x() += 50.0;
  EXPECT_THROW(Session(ball(), beside, setup()), Error);
}

}  // namespace
}  // namespace spinaltap
