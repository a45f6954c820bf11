// Heat of whole drillings, solved on a grid: of a session, of its record, and what is written of it.

#include "vdb/sim/solve_heat.h"
#include "tests/support/release_only.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "core/files/recorded_setup.h"
#include "core/session/cutting_motion.h"
#include "core/session/operator/path_motion.h"
#include "tests/support/analytic_bodies.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_kind.h"
#include "vdb/sim/drilling.h"
#include "vdb/sim/replay.h"

namespace spinaltap {
namespace {

using testing::HasSubstr;

/// A ball as dense as cortex.
const Bone& heated_ball() {
  static const Bone bone(test::bake_ball(test::kLargeBall, 0.25, 1300));
  return bone;
}

SessionSetup heated_setup(double diameter_mm = 3.2) {
  const Vec3 axis = Vec3(0.2, -0.9, 0.3).normalized();
  const Vec3 entry = test::kLargeBall.centre_mm - test::kLargeBall.radius_mm * axis;
  SessionSetup setup;
  setup.path = {"diameter", entry, entry + 8.0 * axis, twist_drill(diameter_mm, 40.0, 118.0, 0.16 * diameter_mm)};
  setup.has_clearances = false;
  setup.volume.spacing_mm = 0.2;
  setup.options.heat.emplace();
  return setup;
}

struct HeatedDrilling {
  SessionSetup setup;
  Drilling drilling;
  SessionRecord record;
};

HeatedDrilling heated(const SessionSetup& setup, const Bone& bone = heated_ball(), double feed_mm_s = 1.0) {
  const test::TemporaryFolder folder;
  SessionSetup named = setup;
  named.bone_hash = bone.hash();
  PlannedMotion motion(named.path, {.rate_hz = 200.0, .feed = {.steps = {{0.0, feed_mm_s}}}});
  const std::filesystem::path file = folder.path() / "run.h5";
  RecordWriter writer(file, record_setup(named), false, {}, record_parts(named.path.bit, named.options));
  Drilling drilling = drill_bone(bone, named, motion, {.record = &writer});
  writer.close(drilling.events);
  return {named, std::move(drilling), read_record(file)};
}

const HeatedDrilling& heated_diameter() {
  static const HeatedDrilling heated = spinaltap::heated(heated_setup());
  return heated;
}

const SolvedHeat& solved_diameter() {
  static const SolvedHeat heat =
      solve_heat(heated_diameter().drilling.before, heated_diameter().setup, heated_diameter().drilling.heat_steps);
  return heat;
}

SLOW_TESTS("SolveHeat.OfARecordIsThatOfItsSessionToTheLastBitAtAnyThreadCount",
           "SolveHeat.WritesWhatItFoundWhereItFoundIt", "SolveHeat.AccountsForAllHeatThatTheSessionGaveTheBone");

TEST(SolveHeat, AccountsForAllHeatThatTheSessionGaveTheBone) {
  const auto& [setup, drilling, record] = heated_diameter();
  const SolvedHeat& heat = solved_diameter();
  double given_j = 0.0;
  for (const RecordedCycle& cycle : record.cycles) {
    const CuttingState state{cycle.torque_n_mm, cycle.thrust_n, 1250.0, cycle.feed_mm_per_turn,
                             cycle.tip_density_g_cm3};
    given_j += cycle.dt_s * cutting_heat(setup.options.heat->bone, 3.2, state).bone_w;
  }
  const HeatBalance& balance = heat.drilling.balance;
  EXPECT_GT(given_j, 1.0);
  EXPECT_NEAR(balance.given_j + balance.missed_j, given_j, 1e-9 * given_j);
  EXPECT_NEAR(balance.in_bone_j + balance.drilled_j, balance.given_j, 1e-9 * given_j);
  EXPECT_EQ(balance.water_j, 0.0);
}

TEST(SolveHeat, OfARecordIsThatOfItsSessionToTheLastBitAtAnyThreadCount) {
  const auto& [setup, drilling, record] = heated_diameter();
  const SolvedHeat& live = solved_diameter();
  for (const std::size_t threads : {1U, 2U}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const SolvedHeat again = solve_heat(record, "run.h5", heated_ball());
    EXPECT_EQ(again.hottest_c, live.hottest_c);
    EXPECT_EQ(again.hottest_mm, live.hottest_mm);
    EXPECT_EQ(again.harmed_mm3, live.harmed_mm3);
    EXPECT_EQ(again.drilling.balance.in_bone_j, live.drilling.balance.in_bone_j);
  }
}

TEST(SolveHeat, IsNearTheClosedFormThatTheSessionTold) {
  const auto& [setup, drilling, record] = heated_diameter();
  const SolvedHeat& heat = solved_diameter();
  // Voxels of 0.2 mm half a millimetre from the wall or further lie 0.6 mm from it in the mean, and the ball's surface
  // and the hole's floor are in the grid alone: a fifth.
  const double live_k = drilling.heat.max_temperature_c - 37.0;
  ASSERT_EQ(heat.distances[1].distance_mm, 0.5);
  EXPECT_GT(live_k, 5.0);
  EXPECT_NEAR(heat.distances[1].temperature_c - 37.0, live_k, 0.2 * live_k);
  EXPECT_GT(heat.hottest_c, heat.distances[1].temperature_c);
  for (std::size_t n = 1; n < heat.distances.size(); ++n) {
    EXPECT_LT(heat.distances[n].temperature_c, heat.distances[n - 1].temperature_c) << n;
  }
  EXPECT_GT(heat.hottest_depth_mm, 0.0);
  EXPECT_LT(heat.hottest_depth_mm, 8.0);
  const Vec3 from_entry = heat.hottest_mm - setup.path.entry_mm;
  const double along_mm = from_entry.dot(setup.path.direction());
  EXPECT_NEAR(along_mm, heat.hottest_depth_mm, 1e-9);
  EXPECT_NEAR(std::sqrt(from_entry.squaredNorm() - along_mm * along_mm), 1.6, 0.3) << "at the wall";
}

TEST(SolveHeat, IsLessWithWaterAPilotHoleAndFeed) {
  RELEASE_ONLY();
  const auto& [setup, drilling, record] = heated_diameter();
  const double usual_c = solved_diameter().distances[1].temperature_c;
  SolveHeatOptions wet;
  wet.heat = *setup.options.heat;
  wet.heat->is_irrigated = true;
  const SolvedHeat with_water = solve_heat(record, "run.h5", heated_ball(), wet);
  EXPECT_LT(with_water.distances[1].temperature_c, usual_c - 1.0);
  EXPECT_GT(with_water.drilling.balance.water_j, 0.0);

  const auto hottest_c = [](const HeatedDrilling& heated, const Bone& bone) {
    return solve_heat(heated.record, "run.h5", bone).distances[1].temperature_c;
  };
  EXPECT_LT(hottest_c(heated(heated_setup(), heated_ball(), 2.0), heated_ball()), usual_c - 1.0);
  // A hole of 2 mm that is there already: before in the same session, or in the bone itself.
  const HeatedDrilling pilot = heated(heated_setup(2.0));
  SessionSetup second = heated_setup();
  std::vector<ToolInput> inputs;
  for (const RecordedCycle& cycle : pilot.record.cycles) inputs.push_back(input_of(cycle));
  second.holes.push_back(hole_of(inputs, pilot.setup));
  EXPECT_LT(hottest_c(heated(second), heated_ball()), usual_c - 1.0);
  const Bone piloted(pilot.drilling.drilled);
  EXPECT_LT(hottest_c(heated(heated_setup(), piloted), piloted), usual_c - 1.0);
}

TEST(SolveHeat, WritesWhatItFoundWhereItFoundIt) {
  const SolvedHeat& heat = solved_diameter();
  const HeatVolume volume = heat.grid->volume();
  const Vec3 at = volume.geometry.to_index(heat.hottest_mm).array().round();
  EXPECT_LT((volume.geometry.to_patient(at) - heat.hottest_mm).norm(), 1e-9);
  const std::size_t n =
      volume.geometry.offset(static_cast<int>(at.x()), static_cast<int>(at.y()), static_cast<int>(at.z()));
  EXPECT_FLOAT_EQ(volume.max_rise_k[n], static_cast<float>(heat.drilling.hottest.rise_k));
  EXPECT_EQ(*std::ranges::max_element(volume.max_rise_k), volume.max_rise_k[n]);

  const test::TemporaryFolder folder;
  write_heat_volume(heat, folder.path() / "heat.nrrd");
  const std::string bytes = read_whole_file(folder.path() / "heat.nrrd");
  EXPECT_THAT(bytes, testing::StartsWith("NRRD0004\ntype: float\n"));
  const std::size_t head = bytes.find("\n\n") + 2;
  ASSERT_EQ(bytes.size() - head, sizeof(float) * volume.geometry.voxel_count());
  float written_c = 0.0F;
  std::memcpy(&written_c, bytes.data() + head + sizeof(float) * n, sizeof written_c);
  EXPECT_FLOAT_EQ(written_c, static_cast<float>(heat.hottest_c));
}

TEST(SolveHeat, RejectsAnotherBoneWhatIsNoHoleAndNumbersThatMakeNoSense) {
  const SessionSetup& setup = heated_diameter().setup;  // not a binding: lambdas hold on to it
  const Drilling& drilling = heated_diameter().drilling;
  const SessionRecord& record = heated_diameter().record;
  const Bone other(test::bake_ball(test::kLargeBall, 0.25, 1200));
  EXPECT_THAT(test::error_of([&] { solve_heat(record, "run.h5", other); }),
              HasSubstr("expected the bone that was drilled in run.h5"));
  SessionSetup milling = setup;
  milling.options.follows_path = false;
  EXPECT_THAT(test::error_of([&] { solve_heat(drilling.before, milling, drilling.heat_steps); }), HasSubstr("milling"));
  SessionSetup several = setup;
  several.further_bone_hashes = {"0123456789abcdef"};
  EXPECT_THAT(test::error_of([&] { solve_heat(drilling.before, several, drilling.heat_steps); }),
              HasSubstr("one of 2"));
  SolveHeatOptions hot;
  hot.heat.emplace();
  hot.heat->bone.temperature_c = 47.5;
  hot.heat->limit_c = 50.0;
  EXPECT_THAT(test::error_of([&] { solve_heat(drilling.before, setup, drilling.heat_steps, hot); }),
              HasSubstr("cooler"));
  EXPECT_THROW(solve_heat(drilling.before, setup, drilling.heat_steps, {.voxel_mm = 0.0}), Error);
  const Progress cancelled([](std::string_view, double) {});
  cancelled.cancel();
  EXPECT_THROW(solve_heat(drilling.before, setup, drilling.heat_steps, {}, cancelled), Cancelled);
  SessionRecord empty = record;
  empty.cycles.clear();
  EXPECT_THAT(test::error_of([&] { solve_heat(empty, "run.h5", heated_ball()); }), HasSubstr("no cycle"));
}

TEST(SolveHeat, OfASessionWithHeatIsReplayedBitForBit) {
  const auto& [setup, drilling, record] = heated_diameter();
  ASSERT_TRUE(record.parts.has_heat);
  EXPECT_EQ(record.cycles.back().max_temperature_c, drilling.heat.max_temperature_c);
  EXPECT_GT(record.cycles.back().max_temperature_c, 40.0);
  for (const EngineKind engine : {EngineKind::ring, EngineKind::leaf}) {
    const Replay again = replay(record, "run.h5", heated_ball(), engine);
    EXPECT_TRUE(again.is_same()) << again.difference;
    EXPECT_EQ(again.cycles, record.cycles.size());
  }
  SessionRecord other = record;
  other.cycles[500].temperature_c = std::nextafter(other.cycles[500].temperature_c, 100.0);
  EXPECT_THAT(replay(other, "run.h5", heated_ball(), std::nullopt).difference, HasSubstr("cycle 500: temperature_c"));
}

}  // namespace
}  // namespace spinaltap
