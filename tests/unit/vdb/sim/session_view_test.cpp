// What a session leaves for others: its record, and what cameras see.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/base/error.h"
#include "core/session/record/session_record.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/vdb/sim/session_ball.h"
#include "vdb/sim/replay.h"

namespace spinaltap {
namespace {

using test::session_ball::ball;
using test::session_ball::kSessionBall;
using test::session_ball::path;
using test::session_ball::setup;
using test::session_ball::straight_in;
using testing::HasSubstr;
using testing::ThrowsMessage;

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

}  // namespace
}  // namespace spinaltap
