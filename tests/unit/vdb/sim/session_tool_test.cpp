// Sessions that change their tool, and those of any tool anywhere.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <span>
#include <vector>

#include "core/base/error.h"
#include "core/session/record/session_record.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/vdb/sim/session_ball.h"
#include "vdb/sim/build_session.h"
#include "vdb/sim/recorded_hole.h"
#include "vdb/sim/replay.h"

namespace spinaltap {
namespace {

using test::session_ball::ball;
using test::session_ball::kSessionBall;
using test::session_ball::path;
using test::session_ball::round_burr;
using test::session_ball::setup;
using test::session_ball::straight_in;
using testing::HasSubstr;
using testing::ThrowsMessage;

/// Once in, once aside with a burr.
std::vector<RecordedCycle> drill_with_two_tools(Session& session) {
  std::vector<RecordedCycle> rows = session.run(straight_in(250));
  session.set_tool(round_burr(3.0));
  const std::vector<RecordedCycle> more = session.run(straight_in(250, 1.0));
  rows.insert(rows.end(), more.begin(), more.end());
  return rows;
}

TEST(Session, ChangesItsToolAsTwoHolesWouldHaveIt) {
  for (const EngineKind engine : {EngineKind::ring, EngineKind::voxel}) {
    SessionSetup of = setup();
    of.engine = engine;
    of.volume.radius_mm = 4.0;
    Session session(ball(), path(), of);
    const std::vector<RecordedCycle> rows = drill_with_two_tools(session);
    EXPECT_EQ(session.tool(), round_burr(3.0));
    EXPECT_EQ(rows.back().cycle, 499U) << "time and cycles go on";
    EXPECT_DOUBLE_EQ(rows.back().time_s, 0.499);
    const auto change = std::ranges::find(session.events(), EventKind::tool_change, &SessionEvent::kind);
    ASSERT_NE(change, session.events().end());
    EXPECT_EQ(change->cycle, 250U);
    EXPECT_EQ(change->value, 1.0);
    EXPECT_EQ(std::ranges::count(session.events(), EventKind::jump, &SessionEvent::kind), 0)
        << "it has come from nowhere";
    // The same hole by hole: the burr in a session of its own, in what the drill left.
    Session drilled(ball(), path(), of);
    drilled.run(straight_in(250));
    drilled.end_hole();
    drilled.set_tool(round_burr(3.0));
    const std::vector<RecordedCycle> burred = drilled.run(straight_in(250, 1.0));
    std::size_t removed = 0;
    for (std::size_t n = 0; n < burred.size(); ++n) {
      EXPECT_EQ(rows[250 + n].removed, burred[n].removed) << n;
      EXPECT_EQ(rows[250 + n].thrust_n, burred[n].thrust_n) << n;
      removed += burred[n].removed;
    }
    EXPECT_GT(removed, 500U);
    EXPECT_EQ(session.drilled().hash(), drilled.drilled().hash());

    // Both parts are one hole: end, undo, drill again.
    session.end_hole();
    EXPECT_EQ(session.setup().holes.size(), 2U);
    EXPECT_EQ(session.drilled().hash(), drilled.drilled().hash());
    EXPECT_EQ(session.path().bit, round_burr(3.0)) << "the next hole begins with it";
    EXPECT_TRUE(session.undo());
    EXPECT_TRUE(session.setup().holes.empty());
    EXPECT_EQ(session.drilled().hash(), ball().hash());
    EXPECT_FALSE(session.undo());
    session.set_tool(path().bit);
    EXPECT_EQ(drill_with_two_tools(session), rows);
  }
}

TEST(Session, TakesNoToolThatCannotBe) {
  SessionSetup warm = setup();
  warm.options.heat.emplace();
  Session hot(ball(), path(), warm);
  hot.run(straight_in(2));
  EXPECT_THAT([&] { hot.set_tool(round_burr(3.0)); }, ThrowsMessage<Error>(HasSubstr("one tool where heat")));
  Session session(ball(), path(), setup());
  const std::vector<ToolInput> inputs = straight_in(200);
  session.run(std::span(inputs).first(100));
  EXPECT_THAT([&] { session.set_tool(plate_bit(2.0, 0.5, 30.0)); }, ThrowsMessage<Error>(HasSubstr("a plate")));
  EXPECT_THROW(session.set_tool({-1.0, 10.0, 1.0}), Error);
  EXPECT_EQ(session.tool(), path().bit);
  // As if it had not been asked.
  Session same(ball(), path(), setup());
  EXPECT_EQ(session.run(std::span(inputs).subspan(100)).back(), same.run(inputs).back());
}

TEST(Session, RecordsItsToolsAndReplayHasThemAgain) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "tools.h5";
  SessionSetup wide = setup();
  wide.volume.radius_mm = 4.0;
  Session session(ball(), path(), wide);
  session.record(file);
  session.set_tool(path().bit);  // before the first cycle: the record has begun
  const std::vector<RecordedCycle> rows = drill_with_two_tools(session);
  session.end_record();
  const SessionRecord record = read_record(file);
  EXPECT_EQ(record.cycles, rows);
  ASSERT_EQ(record.tools.size(), 2U);
  EXPECT_EQ(record.tools[0].cycle, 0U);
  EXPECT_EQ(record.tools[1].cycle, 250U);
  const Replay again = replay(file, ball());
  EXPECT_TRUE(again.is_same()) << again.difference << again.gap;
  EXPECT_EQ(again.events, session.events().size());
  RecordedHole hole(ball().model(), record, session.setup());
  hole.go_to(1.0);
  EXPECT_EQ(hole.tool(), round_burr(3.0));
  EXPECT_EQ(Bone(hole.drilled()).hash(), session.drilled().hash());
  hole.go_to(0.1);
  EXPECT_EQ(hole.tool(), path().bit);
  SessionRecord other = record;
  other.tools[1].tool.replace(other.tools[1].tool.find("3.0"), 3, "3.1");
  EXPECT_NE(hash_of(other), hash_of(record));
  EXPECT_FALSE(replay(other, file, ball()).is_same());
  EXPECT_THROW(replay_record(*build_session(ball(), session.setup()).session, record), Error);

  // The next hole begins with the burr, and its record as well.
  session.end_hole();
  session.record(folder.path() / "next.h5");
  session.run(straight_in(250, -1.0));
  session.end_record();
  const Replay next = replay(folder.path() / "next.h5", ball());
  EXPECT_TRUE(next.is_same()) << next.difference;
}

// A burr in a hand: no path, 6 mm and more beside where one was, all around the bone.
TEST(Session, WithoutAPathDrillsVoxelsAnywhere) {
  SessionSetup free = setup();
  free.path.bit = round_burr(3.0);
  Session session(std::vector{ball()}, free);
  EXPECT_EQ(session.setup().engine, EngineKind::voxel);
  EXPECT_EQ(session.chosen(), "voxels of 0.1 mm of the whole bone, for no path");
  EXPECT_EQ(Session(ball(), path(), setup()).chosen(), "points 0.1 mm apart within 2 mm of the path, engine ring");
  for (const Vec3& axis : {Vec3(Vec3::UnitX()), Vec3(-Vec3::UnitZ()), Vec3(Vec3(1.0, 1.0, -0.5).normalized())}) {
    std::size_t removed = 0;
    double thrust_n = 0.0;
    for (int n = 0; n < 300; ++n) {
      const Vec3 tip_mm = kSessionBall.centre_mm - (kSessionBall.radius_mm + 1.0 - 0.02 * n) * axis;
      const Cycle& cycle = session.step({tip_mm, axis});
      removed += cycle.step.removed;
      thrust_n = std::max(thrust_n, cycle.force.thrust_n);
      EXPECT_EQ(cycle.depth_mm, 0.0) << "not known without clearances";
      EXPECT_EQ(cycle.state, DrillState::initial);
    }
    EXPECT_GT(removed, 10'000U);
    EXPECT_GT(thrust_n, 1.0);
    session.end_hole();
  }
  EXPECT_THAT(
      [&] {
        SessionSetup points = free;
        points.engine = EngineKind::ring;
        Session(std::vector{ball()}, points);
      },
      ThrowsMessage<Error>(HasSubstr("no path: expected the engine voxel, found ring")));
  EXPECT_THROW(Session(std::vector<Bone>{}, free), Error);
}

TEST(Session, WithoutAPathIsToldByTheBonesSurface) {
  const test::TemporaryFolder folder;
  SessionSetup free = setup();
  free.path.bit = round_burr(2.0);
  free.has_clearances = true;
  free.volume.spacing_mm = 0.3;
  Session session(std::vector{ball()}, free);
  session.record(folder.path() / "free.h5");
  const Vec3 axis = Vec3(0.3, 0.8, -0.5).normalized();
  for (int n = 0; n < 400; ++n) {
    const double deep_mm = 0.02 * n - 2.0;
    const Cycle& cycle = session.step({kSessionBall.centre_mm - (kSessionBall.radius_mm - deep_mm) * axis, axis});
    EXPECT_NEAR(cycle.depth_mm, deep_mm, 0.1) << n;
    EXPECT_TRUE(std::isinf(cycle.clearance.outer_mm)) << "a tool has to come through it somewhere";
    EXPECT_TRUE(std::isinf(cycle.clearance.canal_mm)) << "a ball has none";
  }
  EXPECT_EQ(session.events().front().kind, EventKind::contact);
  EXPECT_EQ(session.events().size(), 1U);
  session.step({kSessionBall.centre_mm + Vec3(900.0, 0.0, 0.0), axis});
  EXPECT_EQ(session.last().depth_mm, -std::numeric_limits<double>::infinity());
  EXPECT_THAT([&] { session.set_tool(plate_bit(4.0, 0.5, 30.0)); }, ThrowsMessage<Error>(HasSubstr("no plate")));
  session.end_record();
  session.set_tool(plate_bit(4.0, 0.5, 30.0));
  EXPECT_TRUE(replay(folder.path() / "free.h5", ball()).is_same());
  session.end_hole();
  EXPECT_GT(session.run(std::vector{ToolInput{{kSessionBall.centre_mm, Vec3::UnitX(), Vec3::UnitY()}, true, 0.001}})
                .back()
                .removed,
            100U);
}

// Where only a region is voxels, a hand beside it goes through bone as through air: it is told at once.
TEST(Session, WithoutAPathTellsOfBoneOutOfItsRegionBeforeItHasTouchedAny) {
  SessionSetup free = setup();
  free.path.bit = round_burr(2.0);
  free.has_clearances = true;
  free.volume.spacing_mm = 0.3;
  free.region_mm = Box3(kSessionBall.centre_mm - Vec3::Constant(3.0), kSessionBall.centre_mm + Vec3::Constant(3.0));
  Session session(std::vector{ball()}, free);
  EXPECT_EQ(session.chosen(), "voxels of 0.3 mm of a region, for no path");
  const Vec3 beside_mm = kSessionBall.centre_mm + Vec3(6.0, 0.0, 0.0);
  session.step({beside_mm + Vec3(0.0, 20.0, 0.0), -Vec3::UnitY()});
  EXPECT_TRUE(session.events().empty()) << "in the air";
  session.step({beside_mm, -Vec3::UnitY()});
  ASSERT_EQ(session.events().size(), 1U);
  EXPECT_EQ(session.events()[0].kind, EventKind::outside_volume);
  EXPECT_NEAR(session.events()[0].value, 3.0, 0.1);
}

}  // namespace
}  // namespace spinaltap
