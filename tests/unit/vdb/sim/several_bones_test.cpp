// Sessions that drill several bones of one patient.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/session/operator/path_motion.h"
#include "core/session/record/session_record.h"
#include "tests/support/random_drilling.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/vdb/sim/voxel_ball.h"
#include "vdb/sim/drilling.h"
#include "vdb/sim/replay.h"

namespace spinaltap {
namespace {

using test::occupancy_words;
using test::section_of_voxels;
using test::voxel_setup;
using testing::HasSubstr;
using testing::ThrowsMessage;

/// Two balls of bone, one behind the other with 1.5 mm of air between, of different density.
const test::Ball kNearBall{Vec3(3.0, -4.0, 5.0), 5.0};
const test::Ball kFarBall{Vec3(3.0, -4.0, 16.5), 5.0};
constexpr std::int16_t kNearHu = 304, kFarHu = 1104;  // eight bits have them

const std::vector<Bone>& near_and_far() {
  static const std::vector<Bone> bones{Bone(test::bake_ball(kNearBall, 0.25, kNearHu)),
                                       Bone(test::bake_ball(kFarBall, 0.25, kFarHu))};
  return bones;
}

/// Through the middle of both, until all of a cone of 3 mm is in the open behind the second.
SessionSetup through_both(const DrillBit& bit = {3.1, 50.0, 3.0}) {
  const Vec3 entry_mm = kNearBall.centre_mm - 5.0 * Vec3::UnitZ();
  return voxel_setup({"both", entry_mm, entry_mm + 25.0 * Vec3::UnitZ(), bit});
}

Drilling drill_both(SessionSetup setup) {
  name_bones(setup, near_and_far());
  PlannedMotion tool_operator(setup.path,
                              {.line = {.lead_in_mm = 1.0}, .rate_hz = 50.0, .feed = {.steps = {{0.0, 1.0}}}});
  return drill_bone(near_and_far(), setup, tool_operator, {.log_step_mm = 0.5});
}

/// Of a cylinder along a ball's diameter.
double through_ball_mm3(const test::Ball& ball, double radius_mm) {
  const double rest = ball.radius_mm * ball.radius_mm - radius_mm * radius_mm;
  return 4.0 / 3.0 * std::numbers::pi * (std::pow(ball.radius_mm, 3) - std::pow(rest, 1.5));
}

TEST(SeveralBones, AreDrilledThroughWithTheThrustOfEach) {
  const SessionSetup setup = through_both();
  const Drilling drilling = drill_both(setup);
  const double hole_mm3 = through_ball_mm3(kNearBall, 1.55) + through_ball_mm3(kFarBall, 1.55);
  EXPECT_NEAR(1e-3 * static_cast<double>(drilling.removed), hole_mm3,
              (0.005 + std::abs(section_of_voxels(setup.path, 0.1) - 1.0)) * hole_mm3);
  const double feed_mm = 60.0 / Spindle().rpm;
  const auto mean_n = [&](double from_mm, double to_mm) {
    double sum_n = 0.0;
    int rows = 0;
    for (const DepthRow& row : drilling.rows) {
      if (row.depth_mm < from_mm || row.depth_mm > to_mm) continue;
      sum_n += row.thrust_n;
      ++rows;
    }
    return sum_n / rows;
  };
  // Where the whole cone is in one of them: 3 mm past where it meets the ball, before it comes out.
  const double near_n = resistance_of_block(setup.path.bit, Material(), kNearHu).thrust_n(feed_mm);
  const double far_n = resistance_of_block(setup.path.bit, Material(), kFarHu).thrust_n(feed_mm);
  EXPECT_GT(far_n, 1.5 * near_n);
  EXPECT_NEAR(mean_n(4.0, 9.0), near_n, 0.04 * near_n);
  EXPECT_NEAR(mean_n(15.5, 20.5), far_n, 0.04 * far_n);
  // Each is written with its own hole: what is left of it is its ball without the cylinder.
  ASSERT_EQ(drilling.further_drilled.size(), 1U);
  const auto hole_of = [](const BoneModel& drilled, const test::Ball& ball) {
    return ball.volume_mm3() - 1e-3 * static_cast<double>(VoxelBone(drilled).occupied_count());
  };
  for (const auto& [drilled, ball] :
       {std::pair{&drilling.drilled, &kNearBall}, std::pair{&drilling.further_drilled[0], &kFarBall}}) {
    EXPECT_NEAR(hole_of(*drilled, *ball), through_ball_mm3(*ball, 1.55), 0.04 * through_ball_mm3(*ball, 1.55));
  }
}

TEST(SeveralBones, HaveClearancesToTheWallsOfAllTogether) {
  SessionSetup setup = through_both({2.0, 50.0, 2.0});
  setup.has_clearances = true;
  setup.path.target_mm = setup.path.entry_mm + 18.0 * Vec3::UnitZ();
  name_bones(setup, near_and_far());
  const BuiltSession both = build_session(near_and_far(), setup);
  // The outline's place that is least deep in the two balls, of those past the entry opening.
  const auto expected_mm = [&](double depth_mm) {
    double min_mm = std::numeric_limits<double>::infinity();
    for (double back_mm = 0.0; depth_mm - back_mm > both.clearances->entry_end_mm(); back_mm += 0.01) {
      const Vec3 place = setup.path.entry_mm + Vec3(std::min(1.0, 0.5 * back_mm), 0.0, depth_mm - back_mm);
      double in_mm = -std::numeric_limits<double>::infinity();
      for (const test::Ball& ball : {kNearBall, kFarBall}) {
        in_mm = std::max(in_mm, ball.radius_mm - (place - ball.centre_mm).norm());
      }
      min_mm = std::min(min_mm, in_mm);
    }
    return min_mm;
  };
  // Half way between the balls distances have an edge, which a lattice of 0.4 mm rounds off by half of that; distances
  // themselves are right to 0.03 mm.
  for (const double depth_mm : {3.0, 7.0, 9.5, 10.4, 10.75, 11.2, 13.0, 16.5, 18.0}) {
    ToolInput input;
    input.pose = {setup.path.entry_mm + depth_mm * Vec3::UnitZ(), Vec3::UnitZ()};
    EXPECT_NEAR(both.session->step(input).clearance.outer_mm, expected_mm(depth_mm), 0.23) << depth_mm;
  }
  EXPECT_NEAR(expected_mm(16.5), -(std::hypot(5.75, 1.0) - 5.0), 0.01) << "the shaft in the middle of the gap";
  // The first alone says how far the tip is from it.
  SessionSetup alone = setup;
  name_bones(alone, std::span(near_and_far()).first(1));
  const BuiltSession first = build_session(near_and_far()[0], alone);
  EXPECT_LT(
      first.clearances->of(BitProfile(setup.path.bit), {setup.path.entry_mm + 16.5 * Vec3::UnitZ(), Vec3::UnitZ()})
          .outer_mm,
      -6.0);
}

TEST(SeveralBones, ComeBackWithUndoAndReplayBitForBit) {
  const test::TemporaryFolder folder;
  const SessionSetup setup = through_both({4.0, 40.0, 1.0, BitShape::round_burr, 0.0, 2.0});
  std::vector<ToolInput> inputs;
  test::Random random(5);
  for (int n = 0; n <= 400; ++n) {
    const Vec3 off_mm = 0.1 * random.direction();
    inputs.push_back({{setup.path.entry_mm + (0.06 * n - 1.0) * Vec3::UnitZ() + off_mm, Vec3::UnitZ()}, true, 1e-3});
  }
  Session session(near_and_far(), setup.path, setup);
  EXPECT_EQ(session.setup().further_bone_hashes, std::vector{near_and_far()[1].hash()});
  const std::vector<std::uint64_t> whole = occupancy_words(session);
  const std::size_t blocks[2] = {session.surface_changes(0).size(), session.surface_changes(1).size()};
  session.run(inputs);
  EXPECT_GT(session.surface_changes(0).size(), 0U);
  const std::size_t changed = session.surface_changes(1).size();
  EXPECT_GT(changed, 0U);
  EXPECT_LT(changed, blocks[1]);
  EXPECT_GT(blocks[0], 0U);
  EXPECT_THAT([&] { session.surface_changes(2); }, ThrowsMessage<Error>(HasSubstr("a bone below 2")));
  std::vector<Bone> drilled = session.drilled_bones();
  ASSERT_EQ(drilled.size(), 2U);
  EXPECT_EQ(drilled[0].hash(), session.drilled().hash());
  for (std::size_t n = 0; n < 2; ++n) EXPECT_NE(drilled[n].hash(), near_and_far()[n].hash());
  // From the side, both balls are seen, the one above the other, and the shaft between.
  const Vec3 middle_mm = 0.5 * (kNearBall.centre_mm + kFarBall.centre_mm);
  const Camera camera = look_at(middle_mm - 60.0 * Vec3::UnitX(), middle_mm, Vec3::UnitZ(), 0.5, 61, 61);
  const View view = session.view(camera);
  const auto seen = [&](double up_mm) {
    const int row = 30 - static_cast<int>(std::lround(up_mm * camera.fy / 60.0));
    return static_cast<Seen>(view.mask[view.pixel(30, row)]);
  };
  EXPECT_EQ(seen(5.75), Seen::bone);
  EXPECT_EQ(seen(-5.75), Seen::bone);
  EXPECT_EQ(seen(0.0), Seen::bit);

  EXPECT_TRUE(session.undo());
  EXPECT_EQ(occupancy_words(session), whole);
  drilled = session.drilled_bones();
  for (std::size_t n = 0; n < 2; ++n) EXPECT_EQ(drilled[n].hash(), near_and_far()[n].hash());
  session.record(folder.path() / "both.h5");
  session.run(inputs);
  session.end_record();
  const SessionRecord record = read_record(folder.path() / "both.h5");
  EXPECT_TRUE(replay(record, "both.h5", near_and_far()).is_same());
  EXPECT_THAT([&] { replay(record, "both.h5", near_and_far()[0]); },
              ThrowsMessage<Error>(HasSubstr("expected the 2 bones")));
  const std::vector<Bone> swapped{near_and_far()[1], near_and_far()[0]};
  EXPECT_THAT([&] { replay(record, "both.h5", swapped); }, ThrowsMessage<Error>(HasSubstr("another patient's")));
}

TEST(SeveralBones, NeedVoxels) {
  SessionSetup setup = through_both();
  setup.engine = EngineKind::automatic;
  EXPECT_EQ(Session(near_and_far(), setup.path, setup).setup().engine, EngineKind::voxel);
  EXPECT_EQ(Session(near_and_far()[0], setup.path, setup).setup().engine, EngineKind::ring);
  for (const EngineKind engine : {EngineKind::ring, EngineKind::leaf}) {
    setup.engine = engine;
    EXPECT_THAT([&] { Session(near_and_far(), setup.path, setup); },
                ThrowsMessage<Error>(HasSubstr("several bones: expected the engine voxel")));
  }
  setup.engine = EngineKind::voxel;
  EXPECT_THAT([&] { Session(std::vector<Bone>(), setup.path, setup); }, ThrowsMessage<Error>(HasSubstr("a bone")));
  EXPECT_THAT([&] { Session(std::vector(2, near_and_far()[0]), setup.path, setup); },
              ThrowsMessage<Error>(HasSubstr("one twice")));
  EXPECT_THAT([&] { build_session(near_and_far(), setup); }, ThrowsMessage<Error>(HasSubstr("expected 1 bones")));
}

}  // namespace
}  // namespace spinaltap
