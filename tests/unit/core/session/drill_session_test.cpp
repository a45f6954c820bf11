#include "core/session/drill_session.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/base/error.h"
#include "core/session/operator/force_controlled.h"
#include "core/session/operator/path_motion.h"
#include "core/session/operator/recorded_motion.h"
#include "tests/support/drill_block.h"
#include "tests/support/nan.h"

namespace spinaltap {
namespace {

using test::kNan;

double even(double depth_mm) { return depth_mm >= 0.0 ? 600.0 : kNan; }
double hard_slab(double depth_mm) { return depth_mm >= 0.0 && depth_mm <= 8.0 ? 600.0 : kNan; }

/// Steps of 10 µs at 1 mm/s.
void advance(DrillSession& session, const test::DrillBlock& block, double from_mm, double to_mm,
             double step_mm = 0.01) {
  const int steps = static_cast<int>(std::lround((to_mm - from_mm) / step_mm));
  for (int n = 0; n <= steps; ++n) {
    session.step({block.at(from_mm + (to_mm - from_mm) * n / steps), true, step_mm});
  }
}

TEST(DrillSession, CountsCyclesAndTime) {
  test::DrillBlock block(even);
  const auto session = block.session();
  constexpr int kCycles = 500'001;
  for (int n = 0; n < kCycles; ++n) session->step({block.at(-1.0), true, 0.001});
  EXPECT_EQ(session->last().index, 500'000U);
  EXPECT_DOUBLE_EQ(session->last().time_s, 500.0);  // a plain sum of thousandths is 1e-11 s off by then
  EXPECT_NEAR(session->last().depth_mm, -1.0, 1e-9);
  EXPECT_EQ(session->feedback().time_s, session->last().time_s);
}

TEST(DrillSession, RemovesFeelsAndNotesContact) {
  test::DrillBlock block(even);
  const std::size_t before = block.volumes.front().occupied_count();
  const auto session = block.session();
  std::size_t removed = 0;
  for (int n = 0; n <= 900; ++n) removed += session->step({block.at(-1.0 + 0.01 * n), true, 0.01}).step.removed;
  EXPECT_EQ(removed, before - block.volumes.front().occupied_count());
  const double mm_a_turn = 1.0 / (1250.0 / 60.0);
  const CuttingResistance resistance = resistance_of_block(block.path.bit, block.material, 600.0);
  EXPECT_NEAR(session->last().force.thrust_n, resistance.thrust_n(mm_a_turn), 0.02 * resistance.thrust_n(mm_a_turn));
  ASSERT_FALSE(session->events().empty());
  EXPECT_EQ(session->events().front().kind, EventKind::contact);
  EXPECT_NEAR(session->events().front().depth_mm, 0.0, 0.1 + 1e-9);
  EXPECT_EQ(test::events_of(*session, EventKind::contact).size(), 1U);
}

TEST(DrillSession, NotesABreakthroughWithTheThrustBefore) {
  test::DrillBlock block(hard_slab);
  const auto session = block.session();
  advance(*session, block, -1.0, 15.0);
  const auto events = test::events_of(*session, EventKind::breakthrough);
  ASSERT_EQ(events.size(), 1U);
  EXPECT_NEAR(events[0].depth_mm, 8.0, 0.1);
  EXPECT_NEAR((events[0].place_mm - block.at(events[0].depth_mm).tip_mm).norm(), 0.0, 1e-6);
  const double whole_n = resistance_of_block(block.path.bit, block.material, 600.0).thrust_n(0.048);
  EXPECT_NEAR(events[0].value, whole_n, 0.03 * whole_n);
  // The operator went on as if nothing were.
  const auto over = test::events_of(*session, EventKind::plunge);
  ASSERT_EQ(over.size(), 1U);
  EXPECT_NEAR(over[0].value, 15.0 - events[0].depth_mm, 1e-6);
}

TEST(DrillSession, TellsOfNoPathWhereTheToolLeavesIt) {
  const auto run = [](bool follows_path) {
    test::DrillBlock block(hard_slab);
    SessionOptions options;
    options.stop.thrust_n = 5.0;
    options.follows_path = follows_path;
    const auto session = block.session(options);
    std::vector<Cycle> cycles;
    for (int n = 0; n <= 1600; ++n) cycles.push_back(session->step({block.at(-1.0 + 0.01 * n), true, 0.01}));
    return std::pair(cycles, std::vector<SessionEvent>(session->events().begin(), session->events().end()));
  };
  const auto [drilled, drilling] = run(true);
  const auto [milled, milling] = run(false);
  std::vector<SessionEvent> expected;
  for (const SessionEvent& event : drilling) {
    const bool is_of_a_path =
        event.kind == EventKind::state || event.kind == EventKind::breakthrough || event.kind == EventKind::plunge;
    if (!is_of_a_path) expected.push_back(event);
  }
  EXPECT_LT(expected.size() + 3, drilling.size()) << "there were some of each";
  ASSERT_EQ(milling.size(), expected.size());
  for (const EventKind kept : {EventKind::contact, EventKind::stop_thrust}) {
    EXPECT_EQ(std::ranges::count(milling, kept, &SessionEvent::kind), 1);
  }
  for (std::size_t n = 0; n < expected.size(); ++n) {
    EXPECT_EQ(milling[n].kind, expected[n].kind);
    EXPECT_EQ(milling[n].cycle, expected[n].cycle);
    EXPECT_EQ(milling[n].value, expected[n].value);
  }
  EXPECT_NE(drilled.back().state, DrillState::initial);
  for (std::size_t n = 0; n < milled.size(); ++n) {
    EXPECT_EQ(milled[n].state, DrillState::initial);
    EXPECT_EQ(milled[n].step.removed, drilled[n].step.removed);
    EXPECT_EQ(milled[n].force.thrust_n, drilled[n].force.thrust_n);
  }
}

TEST(DrillSession, TakesNeitherTheHoleNorTheVolumesEndForABreakthrough) {
  test::DrillBlock block(even);
  const auto session = block.session();
  advance(*session, block, -1.0, 6.0);
  advance(*session, block, 6.0, 2.0);
  advance(*session, block, 2.0, 6.0);
  advance(*session, block, 6.0, 23.0);
  EXPECT_TRUE(test::events_of(*session, EventKind::breakthrough).empty());
  // 3 mm past the volume's end, in what may well be bone.
  const auto left = test::events_of(*session, EventKind::outside_volume);
  ASSERT_EQ(left.size(), 1U);
  EXPECT_NEAR(left[0].value, 3.0, 0.06);
}

TEST(DrillSession, NotesABitThatReachesOutOfTheCylindersSide) {
  test::DrillBlock block(even);
  const auto session = block.session();
  const Vec3 aside = any_perpendicular(block.path.direction());
  advance(*session, block, -1.0, 5.0);
  EXPECT_TRUE(test::events_of(*session, EventKind::outside_volume).empty());
  for (int n = 0; n <= 150; ++n) session->step({block.at(5.0, 0.01 * n * aside), true, 0.01});
  for (int n = 150; n >= 0; --n) session->step({block.at(5.0, 0.01 * n * aside), true, 0.01});
  const auto left = test::events_of(*session, EventKind::outside_volume);
  ASSERT_EQ(left.size(), 1U);
  EXPECT_NEAR(left[0].value, 1.5 + 1.5 - 2.45, 1e-6);  // way aside, radius, and the outermost ring with its share
}

TEST(DrillSession, RejectsPosesWithoutSenseAndStaysAlive) {
  test::DrillBlock block(even);
  const auto session = block.session();
  advance(*session, block, -1.0, 3.0);
  const Cycle before = session->last();
  const double infinite = std::numeric_limits<double>::infinity();
  const std::vector<ToolInput> bad{
      {{Vec3(kNan, 0.0, 0.0), Vec3::UnitZ()}, true, 0.001},
      {{block.at(3.0).tip_mm, Vec3(0.0, kNan, 0.0)}, true, 0.001},
      {{block.at(3.0).tip_mm, Vec3::Zero()}, true, 0.001},
      {{block.at(3.0).tip_mm, 3.0 * Vec3::UnitZ()}, true, 0.001},
      {{Vec3(infinite, 0.0, 0.0), Vec3::UnitZ()}, true, 0.001},
      {{Vec3(1e5, 0.0, 0.0), Vec3::UnitZ()}, true, 0.001},
      {block.at(3.0), true, 0.0},
      {block.at(3.0), true, -1.0},
      {block.at(3.0), true, kNan},
  };
  for (const ToolInput& input : bad) {
    const Cycle& cycle = session->step(input);
    EXPECT_EQ(cycle.step.removed, 0U);
    EXPECT_EQ(cycle.force.force_n, Vec3::Zero());
    EXPECT_EQ(cycle.depth_mm, before.depth_mm);
    EXPECT_EQ(cycle.state, before.state);
  }
  EXPECT_EQ(session->last().index, before.index + bad.size());
  EXPECT_NEAR(session->last().time_s, before.time_s + 0.006, 1e-9);  // those with a time of their own
  const auto rejected = test::events_of(*session, EventKind::invalid_pose);
  ASSERT_EQ(rejected.size(), 1U) << "a row of them is one event";
  EXPECT_EQ(rejected[0].value, static_cast<double>(bad.size()));
  EXPECT_EQ(rejected[0].cycle, before.index + 1);
  // The way from the last good pose is cut.
  EXPECT_GT(session->step({block.at(3.5), true, 0.1}).step.removed, 0U);
  session->step(bad[0]);
  EXPECT_EQ(test::events_of(*session, EventKind::invalid_pose).size(), 2U);
}

TEST(DrillSession, NormalisesAxesThatAreNearlyUnit) {
  test::DrillBlock exact(even), rough(even);
  const auto a = exact.session();
  const auto b = rough.session();
  for (int n = 0; n <= 300; ++n) {
    const Pose pose = exact.at(0.01 * n);
    a->step({pose, true, 0.01});
    b->step({{pose.tip_mm, 1.0001 * pose.axis}, true, 0.01});
  }
  EXPECT_EQ(exact.volumes.front().occupied_count(), rough.volumes.front().occupied_count());
  EXPECT_TRUE(test::events_of(*b, EventKind::invalid_pose).empty());
}

TEST(DrillSession, DoesNotCutTheWayOfAJump) {
  test::DrillBlock block(even, 60.0);
  const auto session = block.session();
  session->step(block.input(-1.0));
  const std::size_t before = block.volumes.front().occupied_count();
  // 50.5 mm forward in one cycle, then back beside: what is between stays but where the bit itself is.
  const Cycle& cycle = session->step(block.input(49.5));
  const auto jumps = test::events_of(*session, EventKind::jump);
  ASSERT_EQ(jumps.size(), 1U);
  EXPECT_NEAR(jumps[0].value, 50.5, 1e-9);
  EXPECT_EQ(cycle.force.thrust_n, 0.0) << "what it holds there was not cut on a way";
  EXPECT_GT(cycle.step.removed, 0U) << "it is there, turning";
  test::DrillBlock swept(even, 60.0);
  const auto slow = swept.session({.max_jump_mm = 51.0});
  slow->step(swept.input(-1.0));
  slow->step(swept.input(49.5));
  EXPECT_TRUE(test::events_of(*slow, EventKind::jump).empty());
  // A bit of 60 mm stands in all of the hole: both ways end alike.
  EXPECT_EQ(block.volumes.front().occupied_count(), swept.volumes.front().occupied_count());
  EXPECT_LT(block.volumes.front().occupied_count(), before);
  // Sideways out of the bone and back, at one go each: nothing is cut but what the bit holds.
  const std::size_t holed = block.volumes.front().occupied_count();
  const Vec3 aside = any_perpendicular(block.path.direction());
  session->step({block.at(49.5, 60.0 * aside), true, 0.001});
  EXPECT_EQ(block.volumes.front().occupied_count(), holed);
  EXPECT_EQ(test::events_of(*session, EventKind::jump).size(), 2U);
  // Turning about the tip moves the base as far.
  session->step({{block.at(49.5, 60.0 * aside).tip_mm, -block.path.direction()}, true, 0.001});
  EXPECT_EQ(test::events_of(*session, EventKind::jump).size(), 3U);
}

TEST(DrillSession, CutsNothingWithTheSpindleOff) {
  test::DrillBlock block(even);
  const auto session = block.session();
  advance(*session, block, -1.0, 2.0);
  const std::size_t occupied = block.volumes.front().occupied_count();
  for (int n = 0; n <= 100; ++n) {
    const Cycle& cycle = session->step({block.at(2.0 + 0.001 * n), false, 0.001});
    EXPECT_EQ(cycle.step.removed, 0U);
    EXPECT_EQ(cycle.force.thrust_n, 0.0);
    EXPECT_EQ(cycle.force.torque_n_mm, 0.0);
  }
  EXPECT_EQ(block.volumes.front().occupied_count(), occupied);
  const double most_n = session->last().force.contact_n.norm();
  EXPECT_LT(session->last().force.contact_n.dot(block.path.direction()), 0.0) << "it is pushed back out";
  auto touches = test::events_of(*session, EventKind::touch);
  ASSERT_EQ(touches.size(), 1U);
  EXPECT_EQ(touches[0].value, most_n) << "the deeper, the more";
  // Out, aside and in again with the spindle off; started again, it cuts where it is and not the way there.
  const Vec3 aside = any_perpendicular(block.path.direction());
  session->step({block.at(-3.0), false, 0.001});
  session->step({block.at(-3.0, 0.5 * aside), false, 0.001});
  const Cycle& started = session->step({block.at(-3.0, 0.5 * aside), true, 0.001});
  EXPECT_EQ(started.step.removed, 0U);
  EXPECT_EQ(block.volumes.front().occupied_count(), occupied);
  EXPECT_EQ(session->last().state, DrillState::outer_cortical);
  touches = test::events_of(*session, EventKind::touch);
  ASSERT_EQ(touches.size(), 1U) << "free of the bone it touched nothing";
}

TEST(DrillSession, StopsAtAThrust) {
  // Cancellous bone on something hard.
  test::DrillBlock block([](double depth_mm) { return depth_mm < 0.0 ? kNan : depth_mm < 5.0 ? 200.0 : 1200.0; });
  SessionOptions options;
  options.stop.thrust_n = 20.0;
  const auto session = block.session(options);
  PathMotionOptions motion;
  motion.line.lead_in_mm = 1.0;
  PlannedMotion tool_operator(block.path, motion);
  run_session(*session, tool_operator);
  EXPECT_TRUE(session->is_stopped());
  EXPECT_TRUE(session->feedback().stop);
  const auto stops = test::events_of(*session, EventKind::stop_thrust);
  ASSERT_EQ(stops.size(), 1U);
  EXPECT_GE(stops[0].value, 20.0);
  EXPECT_GT(stops[0].depth_mm, 4.8);
  EXPECT_LT(stops[0].depth_mm, 6.0);
  EXPECT_EQ(session->last().depth_mm, stops[0].depth_mm) << "this operator ends at once";
  EXPECT_TRUE(test::events_of(*session, EventKind::plunge).empty());
}

TEST(DrillSession, KeepsRoomForSoManyEventsAndCountsTheRest) {
  test::DrillBlock block(even);
  const auto session = block.session();
  const Vec3 aside = any_perpendicular(block.path.direction());
  const std::size_t jumps = DrillSession::kMaxEvents + 10;
  session->step({block.at(-5.0), true, 0.001});
  const SessionEvent* const room = session->events().data();
  for (std::size_t n = 0; n < jumps; ++n)
    session->step({block.at(-5.0, (n % 2 == 0 ? 60.0 : 0.0) * aside), true, 0.001});
  EXPECT_EQ(session->events().size(), DrillSession::kMaxEvents);
  EXPECT_EQ(session->events_lost(), 10U);
  EXPECT_EQ(session->events().data(), room) << "nothing was allocated";
}

TEST(DrillSession, RejectsPlansOutsideTheVolumeAndOptionsWithoutSense) {
  test::DrillBlock block(even);
  const auto make = [&](const DrillPath& path, const SessionOptions& options = {}) {
    DrillSession session(path, block.volumes, make_ring_engine(block.volumes.front(), path.bit, block.material),
                         block.material, nullptr, options);
  };
  EXPECT_NO_THROW(make(block.path));
  const Vec3 aside = any_perpendicular(block.path.direction());
  DrillPath beside = block.path;
  beside.entry_mm += 5.0 * aside;
  beside.target_mm += 5.0 * aside;
  EXPECT_THROW(make(beside), Error);
  DrillPath longer = block.path;
  longer.target_mm += 10.0 * block.path.direction();
  EXPECT_THROW(make(longer), Error);
  DrillPath none = block.path;
  none.target_mm = Vec3(kNan, 0.0, 0.0);
  EXPECT_THROW(make(none), Error);
  for (const SessionOptions& options :
       {SessionOptions{.spindle = {.rpm = kNan}}, SessionOptions{.spindle = {.rpm = -1.0}},
        SessionOptions{.stop = {.thrust_n = 0.0}}, SessionOptions{.stop = {.thrust_n = kNan}},
        SessionOptions{.stop = {.clearance_mm = kNan}}, SessionOptions{.states = {.hold_mm = kNan}},
        SessionOptions{.max_jump_mm = 0.0}, SessionOptions{.max_jump_mm = kNan},
        SessionOptions{.has_device = true, .has_support = false}}) {
    EXPECT_THROW(make(block.path, options), Error);
  }
  test::DrillBlock empty([](double) { return kNan; });
  EXPECT_THROW(empty.session(), Error) << "the plan misses the bone";
  EXPECT_THROW(DrillSession(block.path, block.volumes, nullptr, block.material, nullptr), Error);
  std::vector<PointVolume> no_volumes;
  EXPECT_THROW(DrillSession(block.path, no_volumes, make_ring_engine(block.volumes.front(), block.path.bit, {}),
                            block.material, nullptr),
               Error);
}

/// Bit for bit.
void expect_same(const Cycle& a, const Cycle& b) {
  const auto same = [](double x, double y) { return std::memcmp(&x, &y, sizeof(x)) == 0; };
  EXPECT_EQ(a.step.removed, b.step.removed);
  EXPECT_TRUE(same(a.step.work_n_mm, b.step.work_n_mm));
  EXPECT_TRUE(same(a.force.thrust_n, b.force.thrust_n));
  EXPECT_TRUE(same(a.force.torque_n_mm, b.force.torque_n_mm));
  EXPECT_TRUE(same(a.force.tip_density_g_cm3, b.force.tip_density_g_cm3));
  for (int axis = 0; axis < 3; ++axis) EXPECT_TRUE(same(a.force.force_n[axis], b.force.force_n[axis]));
  EXPECT_TRUE(same(a.time_s, b.time_s));
  EXPECT_EQ(a.state, b.state);
}

TEST(DrillSession, IsTheSameWithEveryEngineAndNumberOfThreads) {
  const auto layers = [](double depth_mm) {
    return depth_mm < 0.0 || depth_mm > 9.0 ? kNan : 500.0 + 400.0 * std::sin(3.0 * depth_mm);
  };
  const auto run = [&](test::DrillBlock::MakeEngine make_engine, std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    test::DrillBlock block(layers, 12.0, DrillBit{}, 0.2);
    const auto session = block.session({}, nullptr, make_engine);
    PathMotionOptions motion;
    motion.line = {.lead_in_mm = 1.0, .tilt_deg = 4.0};
    motion.feed.steps = {{0.0, 5.0}};
    motion.tremor_mm = 0.1;
    PlannedMotion tool_operator(block.path, motion);
    std::vector<Cycle> cycles;
    run_session(*session, tool_operator, [&](const Cycle& cycle) { cycles.push_back(cycle); });
    return std::pair(cycles, std::vector<SessionEvent>(session->events().begin(), session->events().end()));
  };
  const auto [first, first_events] = run(make_reference_engine, 1);
  EXPECT_GT(first.size(), 2'000U);
  EXPECT_GT(first_events.size(), 2U);
  struct Other {
    test::DrillBlock::MakeEngine make_engine;
    std::size_t threads;
  };
  const auto ring = test::DrillBlock::MakeEngine{make_ring_engine};
  for (const auto& [make_engine, threads] :
       {Other{make_arc_engine, 1}, Other{ring, 1}, Other{ring, 2}, Other{make_reference_engine, 2}}) {
    const auto [cycles, events] = run(make_engine, threads);
    ASSERT_EQ(cycles.size(), first.size());
    for (std::size_t n = 0; n < cycles.size(); ++n) expect_same(cycles[n], first[n]);
    ASSERT_EQ(events.size(), first_events.size());
    for (std::size_t n = 0; n < events.size(); ++n) {
      EXPECT_EQ(events[n].kind, first_events[n].kind);
      EXPECT_EQ(events[n].cycle, first_events[n].cycle);
      EXPECT_EQ(events[n].value, first_events[n].value);
    }
  }
}

TEST(DrillSession, IsTheSameWithoutTheSupportOfTheHolesWallButForThatForce) {
  const auto slab = [](double depth_mm) { return depth_mm < 0.0 || depth_mm > 6.0 ? kNan : 600.0; };
  const auto run = [&](SessionOptions options, bool pushes, bool has_support) {
    test::DrillBlock block(slab, 9.0, twist_drill(3.0, 60.0, 118.0, 0.48), 0.2);
    options.has_support = has_support;
    options.stop.thrust_n = 60.0;
    const auto session = block.session(options);
    PathMotionOptions motion;
    motion.line = {.lead_in_mm = 1.0, .tilt_deg = 4.0};
    motion.feed.steps = {{0.0, 2.0}};
    motion.tremor_mm = 0.1;
    ForceControlOptions push;
    push.line = motion.line;
    push.push_n = 20.0;
    push.tremor_mm = motion.tremor_mm;
    std::unique_ptr<Operator> tool_operator = std::make_unique<PlannedMotion>(block.path, motion);
    if (pushes) tool_operator = std::make_unique<ForceControlled>(block.path, push);
    std::vector<Cycle> cycles;
    run_session(*session, *tool_operator, [&](const Cycle& cycle) { cycles.push_back(cycle); });
    return std::pair(cycles, std::vector<SessionEvent>(session->events().begin(), session->events().end()));
  };
  SessionOptions compliant;
  compliant.compliance.is_on = true;
  compliant.compliance.stall_n_mm = 40.0;
  for (const bool pushes : {false, true}) {
    for (const SessionOptions& options : {SessionOptions{}, compliant}) {
      SCOPED_TRACE(::testing::Message() << "pushes " << pushes << ", compliant " << options.compliance.is_on);
      const auto [with, with_events] = run(options, pushes, true);
      auto [without, without_events] = run(options, pushes, false);
      ASSERT_EQ(with.size(), without.size());
      ASSERT_GT(with.size(), 1'000U);
      double most_n = 0.0;
      for (std::size_t n = 0; n < with.size(); ++n) {
        const DrillForce &is = with[n].force, &left = without[n].force;
        most_n = std::max(most_n, is.support_n.norm());
        EXPECT_EQ(left.support_n, Vec3::Zero());
        EXPECT_LT((left.force_n + is.support_n - is.force_n).norm(), 1e-9);
        EXPECT_EQ(left.lateral_n, is.lateral_n);
        EXPECT_EQ(left.contact_n, is.contact_n);
        EXPECT_EQ(with[n].pose.tip_mm, without[n].pose.tip_mm);
        EXPECT_EQ(with[n].input.pose.tip_mm, without[n].input.pose.tip_mm);
        without[n].force.force_n = is.force_n;
        expect_same(without[n], with[n]);
      }
      // A bit that gives way on a planned line lies nowhere against the wall.
      EXPECT_TRUE(most_n > 0.5 || (options.compliance.is_on && !pushes)) << "there is some to leave out";
      ASSERT_EQ(with_events.size(), without_events.size());
      EXPECT_GT(with_events.size(), 2U);
      for (std::size_t n = 0; n < with_events.size(); ++n) {
        EXPECT_EQ(with_events[n].kind, without_events[n].kind);
        EXPECT_EQ(with_events[n].cycle, without_events[n].cycle);
        EXPECT_EQ(with_events[n].value, without_events[n].value);
      }
    }
  }
}

TEST(RunSession, ReportsAndCanBeCancelled) {
  test::DrillBlock block(even);
  const auto session = block.session();
  PlannedMotion tool_operator(block.path, {});
  Progress progress;
  double last_share = 0.0;
  progress = Progress([&](std::string_view, double share) {
    EXPECT_GE(share, last_share);
    last_share = share;
    if (share > 0.3) progress.cancel();
  });
  EXPECT_THROW(run_session(*session, tool_operator, {}, progress), Cancelled);
  EXPECT_LT(session->last().depth_mm, 7.0);
}

}  // namespace
}  // namespace spinaltap
