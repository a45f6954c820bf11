#include "vdb/sim/session.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/error.h"
#include "core/session/operator/motion_log.h"
#include "core/session/operator/path_motion.h"
#include "core/session/operator/recorded_motion.h"
#include "mesh/mesh_quality.h"
#include "mesh/remaining_mesh.h"
#include "tests/support/analytic_bodies.h"
#include "tests/support/count_allocations.h"
#include "tests/support/memory_used.h"
#include "tests/support/temporary_folder.h"
#include "vdb/sim/build_session.h"
#include "vdb/sim/replay.h"

namespace spinaltap {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

const test::Ball kSessionBall{Vec3(3.0, -4.0, 5.0), 9.0};

const Bone& ball() {
  static const Bone bone(test::bake_ball(kSessionBall, 0.3));
  return bone;
}

DrillPath path() {
  const Vec3 axis = Vec3(0.2, -0.9, 0.3).normalized();
  const Vec3 entry_mm = kSessionBall.centre_mm - kSessionBall.radius_mm * axis;
  return {"slanting", entry_mm, entry_mm + 8.0 * axis, {2.0, 30.0, 2.0}};
}

/// The ball is no vertebra.
SessionSetup setup() {
  SessionSetup setup;
  setup.has_clearances = false;
  setup.volume = {.radius_mm = 2.0, .spacing_mm = 0.1, .lead_in_mm = 1.0};
  return setup;
}

/// Straight in, `count` cycles of 0.02 mm from 1 mm before the entry on.
std::vector<ToolInput> straight_in(int count, double aside_mm = 0.0) {
  const DrillPath line = path();
  const Vec3 aside = line.direction().cross(Vec3::UnitX()).normalized();
  std::vector<ToolInput> inputs;
  for (int n = 0; n < count; ++n) {
    inputs.push_back(
        {{line.entry_mm + (0.02 * n - 1.0) * line.direction() + aside_mm * aside, line.direction()}, true, 0.001});
  }
  return inputs;
}

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
  const std::size_t alive = session.voxels()->alive_count();
  const std::size_t memory_bytes = test::resident_bytes(), allocations = test::allocation_count();
  for (std::size_t n = 0; n < kCycles; ++n) session.step_input(input(n));
  EXPECT_EQ(test::allocation_count(), allocations);
#ifndef SPINALTAP_INSTRUMENTED  // sanitizers have memory of their own
  EXPECT_LT(static_cast<double>(test::resident_bytes()) - static_cast<double>(memory_bytes), 22e6);
#endif
  EXPECT_GT(session.motion_off_mm(), 0.0);
  EXPECT_LT(session.motion_off_mm(), 0.01);
  const std::size_t left = session.voxels()->alive_count();
  EXPECT_LT(left, alive);

  // The hole that is kept takes the same voxels, but for those that its ways pass by less than they are off.
  session.end_hole();
  EXPECT_NEAR(static_cast<double>(session.voxels()->alive_count()), static_cast<double>(left),
              0.002 * static_cast<double>(alive - left));
  EXPECT_EQ(session.motion_off_mm(), 0.0);
  session.run(std::vector{input(0), input(1)});
  EXPECT_TRUE(session.undo());
  EXPECT_TRUE(session.undo());
  EXPECT_EQ(session.voxels()->alive_count(), alive);
}

TEST(Session, UndoPutsBackTheHoleSoFarAndThenTheOnesBefore) {
  const std::vector<ToolInput> inputs = straight_in(300);
  Session session(ball(), path(), setup());
  EXPECT_FALSE(session.undo());
  const std::vector<RecordedCycle> first = session.run(inputs);
  session.end_hole();
  const std::string one_hole = session.drilled().hash();
  const std::vector<RecordedCycle> second = session.run(straight_in(300, 0.5));
  EXPECT_NE(session.drilled().hash(), one_hole);
  EXPECT_NE(second, first);
  EXPECT_EQ(session.last().index, 299U);

  EXPECT_TRUE(session.undo());
  EXPECT_EQ(session.drilled().hash(), one_hole);
  EXPECT_EQ(session.run(straight_in(300, 0.5)), second) << "the same hole again gives the same";
  EXPECT_TRUE(session.undo());
  EXPECT_TRUE(session.undo());
  EXPECT_EQ(session.drilled().hash(), ball().hash());
  EXPECT_EQ(session.run(inputs), first);
}

using Blocks = std::map<std::array<int, 3>, std::shared_ptr<const SurfaceBlock>>;

void take(const std::vector<SurfaceUpdate>& changes, Blocks& blocks) {
  for (const SurfaceUpdate& change : changes) {
    if (change.surface) {
      blocks[change.block] = change.surface;
    } else {
      EXPECT_EQ(blocks.erase(change.block), 1U) << "a block that was never there is gone";
    }
  }
}

TriangleMesh mesh_of(const Blocks& blocks) {
  std::vector<std::shared_ptr<const SurfaceBlock>> list;
  for (const auto& [place, block] : blocks) list.push_back(block);
  return join_blocks(list);
}

TEST(Session, DrillsEarlierHolesToTheSamePoints) {
  // An operator that trembles and tilts: the hole is no union of a few ways along the axis.
  std::vector<ToolInput> inputs = straight_in(400);
  for (std::size_t n = 0; n < inputs.size(); ++n) {
    const double phase = 0.06 * static_cast<double>(n);
    inputs[n].pose.tip_mm += Vec3(0.1 * std::sin(phase), 0.0, 0.1 * std::cos(1.2 * phase));
    inputs[n].pose.axis = (inputs[n].pose.axis + Vec3(0.02 * std::sin(0.3 * phase), 0.0, 0.0)).normalized();
  }
  for (const EngineKind engine : {EngineKind::ring, EngineKind::voxel}) {
    SessionSetup whole = setup();
    whole.path = path();
    whole.engine = engine;
    BuiltSession built = build_session(ball(), whole);
    for (const ToolInput& input : inputs) built.session->step(input);
    SessionSetup again = whole;
    again.holes = {drilled_hole(inputs, whole.path.bit, whole.options.max_jump_mm)};
    const BuiltSession next = build_session(ball(), again);
    EXPECT_LT(built.bone.alive_count(), build_session(ball(), whole).bone.alive_count());
    EXPECT_EQ(next.bone.alive_count(), built.bone.alive_count());
  }
}

TEST(Session, TellsWhatChangesOfTheSurfaceThroughHolesAndUndo) {
  Session session(ball(), path(), setup());
  Blocks blocks;
  take(session.surface_changes(), blocks);
  const double whole_mm3 = measure_mesh(mesh_of(blocks)).volume_mm3;
  EXPECT_NEAR(whole_mm3, kSessionBall.volume_mm3(), 0.01 * kSessionBall.volume_mm3());
  EXPECT_TRUE(session.surface_changes().empty());

  session.run(straight_in(300));
  take(session.surface_changes(), blocks);
  const MeshQuality drilled = measure_mesh(mesh_of(blocks));
  EXPECT_TRUE(drilled.closed());
  // The cone is 2 mm high and has come 5 mm in; what it meets of the ball before is a cap of some hundredths of a mm.
  const double hole_mm3 = std::numbers::pi * (5.0 - 2.0 + 2.0 / 3.0);
  EXPECT_NEAR(whole_mm3 - drilled.volume_mm3, hole_mm3, 0.05 * hole_mm3);

  session.end_hole();
  session.run(straight_in(200, 3.0));
  take(session.surface_changes(), blocks);
  EXPECT_TRUE(measure_mesh(mesh_of(blocks)).closed());
  EXPECT_LT(measure_mesh(mesh_of(blocks)).volume_mm3, drilled.volume_mm3 - 1.0);
  session.undo();
  take(session.surface_changes(), blocks);
  EXPECT_NEAR(measure_mesh(mesh_of(blocks)).volume_mm3, drilled.volume_mm3, 0.01);
  session.undo();
  take(session.surface_changes(), blocks);
  EXPECT_EQ(measure_mesh(mesh_of(blocks)).volume_mm3, whole_mm3);
}

TEST(Session, KeepsARecordThatReplayFindsTheSameOnItsBoneOnly) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "run.h5";
  Session session(ball(), path(), setup());
  session.record(file);
  const std::vector<RecordedCycle> rows = session.run(straight_in(300));
  EXPECT_THAT([&] { session.undo(); }, ThrowsMessage<Error>(HasSubstr("end it first")));
  session.end_record();

  const SessionRecord record = read_record(file);
  EXPECT_TRUE(record.is_whole);
  EXPECT_EQ(record.cycles, rows);
  for (const EngineKind engine : {EngineKind::ring, EngineKind::reference}) {
    const Replay again = replay(file, ball(), engine);
    EXPECT_TRUE(again.is_same()) << again.difference;
    EXPECT_EQ(again.cycles, rows.size());
  }
  EXPECT_THAT(
      [&] {
        replay(file, Bone(test::bake_ball({kSessionBall.centre_mm, 9.1}, 0.3)));
      },
      ThrowsMessage<Error>(HasSubstr("another patient's")));

  // Its fingerprint is that of what was done, whoever did it; one bit more is another.
  Session other(ball(), path(), setup());
  other.record(folder.path() / "other.h5");
  other.run(straight_in(300));
  other.end_record();
  EXPECT_EQ(hash_of(read_record(folder.path() / "other.h5")), hash_of(record));
  SessionRecord changed = record;
  changed.cycles[200].thrust_n = std::nextafter(changed.cycles[200].thrust_n, 1e9);
  EXPECT_NE(hash_of(changed), hash_of(record));
  EXPECT_THAT([&] { session.record(folder.path() / "late.h5"); }, ThrowsMessage<Error>(HasSubstr("first cycle on")));
}

/// From beside the path's begin, onto its entry.
Camera camera_at_entry() {
  const DrillPath line = path();
  const Vec3 aside = line.direction().cross(Vec3::UnitZ()).normalized();
  return look_at(line.entry_mm - 25.0 * line.direction() + 12.0 * aside, line.entry_mm, Vec3::UnitZ(), 0.5, 120, 90);
}

std::size_t count(const View& view, Seen seen) {
  return static_cast<std::size_t>(std::count(view.mask.begin(), view.mask.end(), static_cast<std::uint8_t>(seen)));
}

/// Mean |distance| of what is seen of the bone to the bone as drilled() has it.
double mean_off_mm(const View& view, const Bone& drilled) {
  std::vector<Vec3> points_mm;
  for (int row = 0; row < view.camera.height; ++row) {
    for (int column = 0; column < view.camera.width; ++column) {
      const std::uint8_t seen = view.mask[view.pixel(column, row)];
      if (seen != 0 && seen != static_cast<std::uint8_t>(Seen::bit)) points_mm.push_back(view.point_mm(column, row));
    }
  }
  double sum_mm = 0.0;
  for (const float one : drilled.distance(points_mm)) sum_mm += std::abs(static_cast<double>(one));
  return sum_mm / static_cast<double>(points_mm.size());
}

TEST(Session, SeesItsHoleAndItsBit) {
  Session session(ball(), path(), setup());
  const Camera camera = camera_at_entry();
  const View before = session.view(camera);
  EXPECT_EQ(before.mask, ball().view(camera).mask);
  EXPECT_EQ(before.depth_mm, ball().view(camera).depth_mm);
  session.run(straight_in(300));
  const View drilling = session.view(camera);
  EXPECT_GT(count(drilling, Seen::bit), 100U);
  // Out again, and away: the hole without the bit. A trembling operator beside it, with the spindle on.
  std::vector<ToolInput> inputs = straight_in(300);
  std::reverse(inputs.begin(), inputs.end());
  for (ToolInput& input : inputs) input.pose.tip_mm += 0.2 * std::sin(input.pose.tip_mm.x() * 40.0) * Vec3::UnitZ();
  session.run(inputs);
  session.step({path().entry_mm - 40.0 * path().direction(), path().direction()});
  const View view = session.view(camera);
  EXPECT_EQ(count(view, Seen::bit), 0U);
  EXPECT_GT(count(view, Seen::wall), 50U);
  const Bone drilled = session.drilled();
  EXPECT_LT(mean_off_mm(view, drilled), 0.005);
  EXPECT_LT(mean_off_mm(drilled.view(camera), drilled), 0.005);

  // The next hole's bit comes from nowhere; the last hole stays.
  session.end_hole();
  EXPECT_EQ(session.view(camera).mask, view.mask);
  EXPECT_TRUE(session.undo());
  EXPECT_EQ(session.view(camera).mask, before.mask);
}

TEST(Session, PutsViewsIntoItsRecordBesideTheCycles) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "run.h5";
  const Camera camera = camera_at_entry();
  Session session(ball(), path(), setup());
  EXPECT_THAT([&] { session.record_view(camera); }, ThrowsMessage<Error>(HasSubstr("begin one first")));
  session.record(file, {.frames = FrameFormat{camera.width, camera.height}});
  EXPECT_THAT([&] { session.record_view(camera); }, ThrowsMessage<Error>(HasSubstr("after the first cycle")));
  std::vector<View> seen;
  for (const ToolInput& input : straight_in(300)) {
    session.step_input(input);
    if (session.last().index % 100 == 99) seen.push_back(session.record_view(camera));
  }
  session.end_record();
  EXPECT_EQ(read_record(file).frame_count, 3U);
  const std::vector<RecordedFrame> frames = read_frames(file);
  ASSERT_EQ(frames.size(), 3U);
  for (std::size_t n = 0; n < frames.size(); ++n) {
    EXPECT_EQ(frames[n].cycle, 100 * n + 99);
    EXPECT_EQ(frames[n].view.depth_mm, seen[n].depth_mm);
    EXPECT_EQ(frames[n].view.normals, seen[n].normals);
    EXPECT_EQ(frames[n].view.mask, seen[n].mask);
  }
  EXPECT_TRUE(replay(file, ball()).is_same());

  Session blind(ball(), path(), setup());
  blind.record(folder.path() / "blind.h5");
  blind.run(straight_in(300));
  EXPECT_THAT([&] { blind.record_view(camera); }, ThrowsMessage<Error>(HasSubstr("takes frames")));
  blind.end_record();
  EXPECT_EQ(hash_of(read_record(folder.path() / "blind.h5")), hash_of(read_record(file)));
}

DrillBit round_burr(double diameter_mm) {
  return {diameter_mm, 40.0, 0.5 * diameter_mm, BitShape::round_burr, 0.0, 0.5 * diameter_mm};
}

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

TEST(Session, RejectsAPathThatMissesTheBone) {
  DrillPath beside = path();
  beside.entry_mm.x() += 50.0;
  beside.target_mm.x() += 50.0;
  EXPECT_THROW(Session(ball(), beside, setup()), Error);
}

}  // namespace
}  // namespace spinaltap
