// Records of sessions against the clock, and beside one that is alike.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/phantom/vertebra.h"
#include "core/session/operator/recorded_motion.h"
#include "tests/support/analytic_bodies.h"
#include "tests/support/temporary_folder.h"
#include "vdb/bake/bake.h"
#include "vdb/sim/replay.h"
#include "vdb/sim/session.h"

namespace spinaltap {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

const test::Ball kRecordedBall{Vec3(-2.0, 6.0, 11.0), 8.0};

class RecordedSession : public testing::Test {
 protected:
  /// Straight in, a pose each 10 µm from 1 mm before the entry on.
  std::vector<ToolInput> inputs(int count) const {
    std::vector<ToolInput> inputs;
    for (int n = 0; n < count; ++n) {
      inputs.push_back({{path_.entry_mm + (0.01 * n - 1.0) * path_.direction(), path_.direction()}, true, 0.001});
    }
    return inputs;
  }

  const test::TemporaryFolder folder_;
  const Bone bone_{test::bake_ball(kRecordedBall, 0.4)};
  const DrillPath path_{"in", kRecordedBall.centre_mm - Vec3(0.0, 8.0, 0.0), kRecordedBall.centre_mm, {2.0, 30.0, 2.0}};
  SessionSetup setup_ = [] {
    SessionSetup setup;
    setup.has_clearances = false;  // the ball is no vertebra
    setup.volume = {.radius_mm = 2.0, .spacing_mm = 0.1, .lead_in_mm = 1.0};
    return setup;
  }();
};

TEST_F(RecordedSession, OfADrillingAgainstTheClockIsReplayedToTheLastBit) {
  const std::filesystem::path file = folder_.path() / "run.h5";
  Session session(bone_, path_, setup_);
  session.record(file, {.words = {{"operator name", "straight"}}, .waits = false});
  RecordedMotion tool(inputs(300), false);
  std::uint64_t observed = 0;
  const RealTimeReport report =
      session.run_real_time(tool, {.longest_s = 20.0}, [&observed](const Cycle&) { ++observed; });
  session.end_record();
  const std::uint64_t lost = session.record_lost();
  // The first pose, where the bit is put, is taken before the clock starts.
  EXPECT_EQ(observed, report.collision.cycles + 1);

  const SessionRecord record = read_record(file);
  EXPECT_EQ(record.cycles.size() + lost, observed);
  EXPECT_EQ(record.setup.at("operator name"), "straight");
  EXPECT_TRUE(record.is_whole);
  if (lost > 0) return;  // a disk that is that slow
  const Replay again = replay(file, bone_);
  EXPECT_TRUE(again.is_same()) << again.difference << again.gap;
  EXPECT_EQ(again.cycles, observed);
  EXPECT_EQ(session.last().depth_mm, record.cycles.back().depth_mm);
}

TEST_F(RecordedSession, IsReplacedOnlyWhereThatIsSaid) {
  const std::filesystem::path file = folder_.path() / "run.h5";
  for (const int count : {20, 30}) {
    Session session(bone_, path_, setup_);
    session.record(file, {.may_replace = true});
    session.run(inputs(count));
    session.end_record();
    EXPECT_EQ(session.record_lost(), 0U);
    EXPECT_EQ(read_record(file).cycles.size(), static_cast<std::size_t>(count));
  }
  Session third(bone_, path_, setup_);
  EXPECT_THAT([&] { third.record(file); }, ThrowsMessage<Error>(HasSubstr("run.h5")));
}

TEST(SessionAlike, TakesOverDistancesToWallsOfTheSamePathOnly) {
  const Bone bone(bake_solid(Vertebra(), {.voxel_mm = 1.0}, 60.0));
  const PedicleLandmarks& pedicle = bone.landmarks().left_pedicle;
  const auto through = [&](double aside_mm, double diameter_mm) {
    const Vec3 middle_mm = pedicle.isthmus_mm + aside_mm * pedicle.width_axis;
    return DrillPath{
        "pedicle", middle_mm - 12.0 * pedicle.axis, middle_mm + 12.0 * pedicle.axis, {diameter_mm, 50.0, 3.0}};
  };
  const auto recorded_along = [](Session& session, const DrillPath& path) {
    std::vector<ToolInput> inputs;
    for (int n = 0; n < 100; ++n) {
      inputs.push_back({{path.entry_mm + 0.2 * n * path.direction(), path.direction()}, true, 0.001});
    }
    return session.run(inputs);
  };
  Session first(bone, through(0.0, 3.0));
  for (const DrillPath& path : {through(0.0, 3.0), through(0.0, 4.0), through(1.0, 3.0)}) {
    Session fresh(bone, path);
    Session alike(bone, path, {}, {}, &first);
    const std::vector<RecordedCycle> expected = recorded_along(fresh, path);
    EXPECT_EQ(recorded_along(alike, path), expected);
    EXPECT_LT(expected.back().canal_mm, 8.0) << "there are walls near";
  }
  // Another bone around the same path has walls of its own.
  const Bone finer(bake_solid(Vertebra(), {.voxel_mm = 0.8}, 60.0));
  Session fresh(finer, through(0.0, 3.0));
  Session alike(finer, through(0.0, 3.0), {}, {}, &first);
  EXPECT_EQ(recorded_along(alike, through(0.0, 3.0)), recorded_along(fresh, through(0.0, 3.0)));
}

}  // namespace
}  // namespace spinaltap
