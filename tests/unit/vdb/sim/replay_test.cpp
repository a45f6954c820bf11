// Replays of a session in a block of bone, and of records that somebody has changed.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/base/error.h"
#include "core/points/point_volume.h"
#include "core/segment/float_grid.h"
#include "core/tool/drill_path.h"
#include "tests/support/analytic_bodies.h"
#include "vdb/detail/bone_grids.h"
#include "vdb/sim/recorded_hole.h"
#include "vdb/sim/replay.h"

namespace spinaltap {
namespace {

using test::kBall;
using testing::HasSubstr;

/// A session in a cylinder of even bone, every point occupied.
struct Block {
  DrillPath path{"block", Vec3(3.0, -4.0, 5.0), Vec3(6.0, 0.0, 5.0), DrillBit{2.0, 20.0, 2.0}};
  std::vector<PointVolume> volumes;
  std::unique_ptr<DrillSession> session;

  Block() {
    volumes.emplace_back(path, PointVolumeOptions{.radius_mm = 1.5, .spacing_mm = 0.2});
    for (int disc = 0; disc < volumes[0].disc_count(); ++disc) {
      for (std::size_t n = 0; n < volumes[0].pattern().point_count(); ++n) volumes[0].set_hu(disc, n, 400.0);
    }
    auto engine = make_ring_engine(volumes[0], path.bit, Material());
    session = std::make_unique<DrillSession>(path, volumes, std::move(engine), Material(), nullptr);
  }
};

/// 400 cycles along the path with a pose that is none among them, which leaves an event.
SessionRecord recorded_block() {
  Block block;
  SessionRecord record;
  for (int n = 0; n < 400; ++n) {
    ToolInput input;
    input.pose = {block.path.entry_mm + 0.01 * n * block.path.direction(), block.path.direction()};
    if (n == 123) input.pose.tip_mm.x() = std::nan("");
    record.cycles.push_back(recorded(block.session->step(input)));
  }
  record.events.assign(block.session->events().begin(), block.session->events().end());
  record.is_whole = true;
  return record;
}

Replay replayed(const SessionRecord& record) {
  Block block;
  return replay_record(*block.session, record);
}

TEST(Replay, FindsEveryBitTheSameInAnUnchangedRecord) {
  const SessionRecord record = recorded_block();
  ASSERT_GE(record.events.size(), 2U) << "contact, invalid pose";
  const Replay replay = replayed(record);
  EXPECT_TRUE(replay.is_same()) << replay.difference << replay.gap;
  EXPECT_EQ(replay.cycles, 400U);
  EXPECT_EQ(replay.events, record.events.size());
  EXPECT_GT(record.cycles[300].thrust_n, 0.0);
}

TEST(Replay, NamesTheFirstCycleAndQuantityThatDiffer) {
  SessionRecord record = recorded_block();
  double& thrust_n = record.cycles[200].thrust_n;
  thrust_n = std::nextafter(thrust_n, 1e9);
  record.cycles[300].depth_mm += 1.0;
  const Replay replay = replayed(record);
  EXPECT_FALSE(replay.is_same());
  EXPECT_THAT(replay.difference, HasSubstr("cycle 200: thrust_n "));
  EXPECT_EQ(replay.cycles, 200U);
}

TEST(Replay, FindsInputsThatSomebodyChanged) {
  SessionRecord record = recorded_block();
  record.cycles[200].tip_mm.x() += 1e-3;
  EXPECT_FALSE(replayed(record).is_same());
}

TEST(Replay, ComparesRecordsCutShortAsFarAsTheyGo) {
  const SessionRecord whole = recorded_block();
  SessionRecord record = whole;
  record.is_whole = false;
  record.cycles.resize(60);
  // Of an event under way the last value was not yet known, and one is of a cycle that is not in the record.
  record.events.front().value += 7.0;
  const Replay replay = replayed(record);
  EXPECT_TRUE(replay.is_same()) << replay.difference;
  EXPECT_EQ(replay.cycles, 60U);
  record.cycles.clear();
  EXPECT_TRUE(replayed(record).is_same());
}

TEST(Replay, ComparesEventsToo) {
  SessionRecord record = recorded_block();
  record.events.back().cycle += 1;
  EXPECT_THAT(replayed(record).difference, HasSubstr("event "));
  record = recorded_block();
  record.events.pop_back();
  EXPECT_THAT(replayed(record).difference, HasSubstr("events: "));
}

TEST(Replay, GoesAsFarAsTheFirstGap) {
  SessionRecord record = recorded_block();
  record.cycles.erase(record.cycles.begin() + 50, record.cycles.begin() + 53);
  const Replay replay = replayed(record);
  EXPECT_FALSE(replay.is_same());
  EXPECT_EQ(replay.difference, "");
  EXPECT_THAT(replay.gap, HasSubstr("from 50 to 53"));
  EXPECT_EQ(replay.cycles, 50U);
}

const DrillBit kRecordedBit{4.0, 40.0, 2.0};

const BoneModel& undrilled_ball() {
  static const BoneModel bone = test::bake_ball(kBall, 0.25);
  return bone;
}

SessionSetup recorded_setup_of_the_hole() {
  SessionSetup setup;
  setup.path.bit = kRecordedBit;
  setup.options.max_jump_mm = 1.0;
  return setup;
}

/// Down through the middle at 10 mm/s, 100 cycles a second, from 12 mm above to 4 mm below it.
SessionRecord record_of_a_straight_hole() {
  SessionRecord record;
  for (int n = 0; n <= 160; ++n) {
    RecordedCycle cycle;
    cycle.cycle = static_cast<std::uint64_t>(n);
    cycle.dt_s = 0.01;
    cycle.time_s = 0.01 * n;
    cycle.tip_mm = kBall.centre_mm + Vec3(0.0, 0.0, 12.0 - 0.1 * n);
    cycle.axis = -Vec3::UnitZ();
    record.cycles.push_back(cycle);
  }
  return record;
}

bool is_left(const BoneModel& bone, double z_mm) {
  const Vec3 p_mm = kBall.centre_mm + Vec3(0.0, 0.0, z_mm);
  std::uint8_t inside = 0;
  bone.inside({&p_mm, 1}, {&inside, 1});
  return inside != 0;
}

/// The deepest place on the axis that is drilled, to 0.1 mm.
double bottom_mm(const BoneModel& bone) {
  double z_mm = 9.5;
  while (z_mm > -9.5 && !is_left(bone, z_mm)) z_mm -= 0.05;
  return z_mm;
}

TEST(RecordedHole, IsAsDeepAsTheTipWasAtAnyMoment) {
  const SessionRecord record = record_of_a_straight_hole();
  RecordedHole hole(undrilled_ball(), record, recorded_setup_of_the_hole());
  EXPECT_DOUBLE_EQ(hole.end_s(), 1.6);
  EXPECT_TRUE(is_left(hole.drilled(), 9.5));
  // Forward, backward, beyond the end and before the begin.
  for (const double time_s : {0.5, 1.0, 0.7, 1.6, 1.1, 99.0, 0.9}) {
    hole.go_to(time_s + 1e-6);
    const double tip_mm = 12.0 - 10.0 * std::min(time_s, 1.6);
    EXPECT_NEAR(hole.pose().tip_mm.z(), kBall.centre_mm.z() + tip_mm, 1e-9);
    // The cone's tip is narrower than a voxel over its last 0.1 mm.
    EXPECT_NEAR(bottom_mm(hole.drilled()), tip_mm, 0.3) << time_s;
  }
  hole.go_to(0.0);
  EXPECT_TRUE(is_left(hole.drilled(), 9.5));
}

TEST(RecordedHole, IsTheSameForwardAndAfterGoingBack) {
  const SessionRecord record = record_of_a_straight_hole();
  RecordedHole forward(undrilled_ball(), record, recorded_setup_of_the_hole());
  RecordedHole restless(undrilled_ball(), record, recorded_setup_of_the_hole());
  forward.go_to(1.2);
  for (const double time_s : {1.5, 0.3, 1.2}) restless.go_to(time_s);
  std::size_t differ = 0;
  const openvdb::FloatGrid& a = *forward.drilled().grids().sdf;
  for (auto voxel = a.cbeginValueOn(); voxel; ++voxel) {
    const float other = restless.drilled().grids().sdf->tree().getValue(voxel.getCoord());
    differ += std::abs(*voxel - other) > 1e-5F ? 1U : 0U;
  }
  EXPECT_EQ(differ, 0U);
}

TEST(RecordedHole, BeginsWithTheHolesThatWereDrilledEarlier) {
  SessionSetup setup = recorded_setup_of_the_hole();
  const Vec3 beside_mm = kBall.centre_mm + Vec3(5.0, 0.0, 0.0);
  const auto pose = [&](double z_mm) { return Pose{beside_mm + Vec3(0.0, 0.0, z_mm), -Vec3::UnitZ()}; };
  setup.holes = {{kRecordedBit, {{pose(12.0), pose(-2.0)}}}};
  const SessionRecord record = record_of_a_straight_hole();
  RecordedHole hole(undrilled_ball(), record, setup);
  for (const double time_s : {0.0, 1.6, 0.5}) {
    hole.go_to(time_s);
    std::uint8_t is_left = 1;
    hole.drilled().inside({&beside_mm, 1}, {&is_left, 1});
    EXPECT_EQ(is_left, 0) << "at " << time_s << " s";
  }
}

TEST(RecordedHole, OfVoxelsIsWhatTheToolSweptInAnyDirection) {
  // A slot: down beside the ball's middle, and then sideways.
  SessionSetup setup = recorded_setup_of_the_hole();
  setup.engine = EngineKind::voxel;
  SessionRecord record = record_of_a_straight_hole();
  for (int n = 1; n <= 100; ++n) {
    RecordedCycle cycle = record.cycles.back();
    cycle.time_s += 0.01;
    cycle.tip_mm.x() += 0.04;
    record.cycles.push_back(cycle);
  }
  RecordedHole hole(undrilled_ball(), record, setup);
  hole.go_to(99.0);
  const Vec3 tip_mm = record.cycles.back().tip_mm;
  const auto is_bone = [&](const Vec3& p) {
    std::uint8_t is_left = 1;
    hole.drilled().inside({&p, 1}, {&is_left, 1});
    return is_left != 0;
  };
  const double radius_mm = kRecordedBit.radius_mm(), above_mm = kRecordedBit.tip_length_mm + 1.0;
  for (double x = 0.0; x <= 4.0; x += 0.1) {
    for (const auto& [aside, is_left] :
         {std::pair(0.0, false), std::pair(radius_mm - 0.1, false), std::pair(radius_mm + 0.1, true)}) {
      EXPECT_EQ(is_bone(tip_mm + Vec3(-x, aside, above_mm)), is_left) << x << " " << aside;
    }
  }
  EXPECT_TRUE(is_bone(tip_mm + Vec3(radius_mm + 0.1, 0.0, above_mm)));
}

TEST(RecordedHole, NeedsACycle) {
  const SessionRecord none;
  EXPECT_THROW(RecordedHole(undrilled_ball(), none, recorded_setup_of_the_hole()), Error);
}

}  // namespace

}  // namespace spinaltap
