#include "core/files/recorded_setup.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/files/detail/session_json.h"

namespace spinaltap {
namespace {

using testing::HasSubstr;

constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// No number is a default, and none is short in decimal.
SessionSetup odd_setup() {
  SessionSetup setup;
  setup.bone_hash = "0123456789abcdef";
  setup.path = {"left", Vec3(0.1, 1.0 / 3.0, -2e-17), Vec3(10.0, 20.0, 30.0 / 7.0), DrillBit{3.1, 41.0, 4.0 / 3.0}};
  setup.path.bit.tip_diameter_mm = 0.7;
  setup.path.screw = PedicleScrew{"a \"screw\"", 6.1, 44.0, 3.9};
  setup.material.density = {0.04 / 3.0, 0.0011};
  setup.material.specific_cutting_energy_mpa = 100.0 / 3.0;
  setup.material.contact_n_mm = 123.4;
  setup.volume = {.radius_mm = 2.9,
                  .spacing_mm = 0.07,
                  .lead_in_mm = 1.3,
                  .hu_bits = HuBits::eight,
                  .subdivision = DiscSubdivision::hexagons,
                  .jitter = 0.3,
                  .jitter_seed = 0xfedcba9876543211ULL};
  setup.fine_spacing_mm = 0.033;
  setup.fine_near_mm = 1.1;
  setup.fine_tip_mm = 2.2;
  setup.engine = EngineKind::leaf;
  setup.region_mm = Box3(Vec3(0.1, -1.0 / 3.0, 2e-17), Vec3(10.0, 20.0 / 7.0, 31.0));
  setup.options.spindle = {1111.1, false};
  setup.options.stop = {55.5, 0.1, true};
  setup.options.states = {0.11, 0.22, 0.66, 4.4, 1.3, 0.12, 0.6};
  setup.options.compliance = {true, 61.0, 190.0, 1.0 / 3.0, 0.2, 0.4, 80.0, 0.05};
  setup.options.max_jump_mm = 49.0;
  setup.options.has_support = false;
  setup.options.heat = HeatOptions{.bone = {.cancellous_density_g_cm3 = 0.21,
                                            .cortical_density_g_cm3 = 5.0 / 3.0,
                                            .cancellous = {2.9e-4 / 3.0, 3.1e-3},
                                            .cortical = {5.3e-4 / 7.0, 2.3e-3},
                                            .temperature_c = 36.6,
                                            .shear_angle_deg = 100.0 / 3.0,
                                            .water_w_mm2_k = 1.1e-3},
                                   .is_irrigated = true,
                                   .distance_mm = 1.0 / 3.0,
                                   .limit_c = 46.9};
  setup.has_clearances = false;
  const Vec3 axis = Vec3(1.0, 2.0, -3.0).normalized();
  setup.holes = {
      {DrillBit{2.3, 39.0, 1.0 / 3.0},
       {{{Vec3(0.1, 0.2, 1.0 / 7.0), axis}, {Vec3(9.1, 1e-17, 3.0), axis}, {Vec3(9.0, 0.1, 3.0), Vec3::UnitX()}},
        {{Vec3(1.0, 2.0, 3.0), axis}}}}};
  return setup;
}

TEST(SessionSetup, ComesBackFromItsTextToTheLastBit) {
  const SessionSetup setup = odd_setup();
  const SessionSetup back = recorded_setup(record_setup(setup), "run.h5");
  EXPECT_EQ(back.bone_hash, setup.bone_hash);
  ASSERT_EQ(back.holes.size(), 1U);
  EXPECT_EQ(back.holes[0].bit.tip_length_mm, 1.0 / 3.0);
  ASSERT_EQ(back.holes[0].ways.size(), 2U);
  for (std::size_t way = 0; way < 2; ++way) {
    const std::vector<Pose>& expected = setup.holes[0].ways[way];
    ASSERT_EQ(back.holes[0].ways[way].size(), expected.size());
    for (std::size_t n = 0; n < expected.size(); ++n) {
      EXPECT_EQ(back.holes[0].ways[way][n].tip_mm, expected[n].tip_mm);
      EXPECT_EQ(back.holes[0].ways[way][n].axis, expected[n].axis);
    }
  }
  EXPECT_EQ(back.path.name, setup.path.name);
  EXPECT_EQ(back.path.entry_mm, setup.path.entry_mm);
  EXPECT_EQ(back.path.target_mm, setup.path.target_mm);
  EXPECT_EQ(back.path.bit.diameter_mm, 3.1);
  EXPECT_EQ(back.path.bit.tip_length_mm, 4.0 / 3.0);
  EXPECT_EQ(back.path.bit.tip_diameter_mm, 0.7);
  ASSERT_TRUE(back.path.screw);
  EXPECT_EQ(back.path.screw->name, "a \"screw\"");
  EXPECT_EQ(back.material.density.at_0_hu, 0.04 / 3.0);
  EXPECT_EQ(back.material.specific_cutting_energy_mpa, 100.0 / 3.0);
  EXPECT_EQ(back.material.contact_n_mm, 123.4);
  EXPECT_EQ(back.volume.radius_mm, 2.9);
  EXPECT_EQ(back.volume.spacing_mm, 0.07);
  EXPECT_EQ(back.volume.lead_in_mm, 1.3);
  EXPECT_EQ(back.volume.hu_bits, HuBits::eight);
  EXPECT_EQ(back.volume.subdivision, DiscSubdivision::hexagons);
  EXPECT_EQ(back.volume.jitter, 0.3);
  EXPECT_EQ(back.volume.jitter_seed, 0xfedcba9876543211ULL);
  EXPECT_EQ(back.fine_spacing_mm, 0.033);
  EXPECT_EQ(back.fine_near_mm, 1.1);
  EXPECT_EQ(back.fine_tip_mm, 2.2);
  EXPECT_EQ(back.engine, EngineKind::leaf);
  ASSERT_TRUE(back.region_mm);
  EXPECT_EQ(back.region_mm->min(), setup.region_mm->min());
  EXPECT_EQ(back.region_mm->max(), setup.region_mm->max());
  EXPECT_EQ(back.options.spindle.rpm, 1111.1);
  EXPECT_FALSE(back.options.spindle.is_clockwise);
  EXPECT_EQ(back.options.stop.thrust_n, 55.5);
  EXPECT_EQ(back.options.stop.clearance_mm, 0.1);
  EXPECT_TRUE(back.options.stop.on_breach);
  EXPECT_EQ(back.options.states.contact_g_cm3, 0.11);
  EXPECT_EQ(back.options.states.hold_mm, 0.12);
  EXPECT_EQ(back.options.max_jump_mm, 49.0);
  EXPECT_FALSE(back.options.has_support);
  ASSERT_TRUE(back.options.heat);
  EXPECT_EQ(back.options.heat->bone.cancellous_density_g_cm3, 0.21);
  EXPECT_EQ(back.options.heat->bone.cortical_density_g_cm3, 5.0 / 3.0);
  EXPECT_EQ(back.options.heat->bone.cancellous.conductivity_w_mm_k, 2.9e-4 / 3.0);
  EXPECT_EQ(back.options.heat->bone.cancellous.capacity_j_mm3_k, 3.1e-3);
  EXPECT_EQ(back.options.heat->bone.cortical.conductivity_w_mm_k, 5.3e-4 / 7.0);
  EXPECT_EQ(back.options.heat->bone.cortical.capacity_j_mm3_k, 2.3e-3);
  EXPECT_EQ(back.options.heat->bone.temperature_c, 36.6);
  EXPECT_EQ(back.options.heat->bone.shear_angle_deg, 100.0 / 3.0);
  EXPECT_EQ(back.options.heat->bone.water_w_mm2_k, 1.1e-3);
  EXPECT_TRUE(back.options.heat->is_irrigated);
  EXPECT_EQ(back.options.heat->distance_mm, 1.0 / 3.0);
  EXPECT_EQ(back.options.heat->limit_c, 46.9);
  EXPECT_FALSE(back.has_clearances);
  // What there is beside: every key at once.
  EXPECT_EQ(to_json(back), to_json(setup));
}

TEST(SessionSetup, KeepsHowAPlateWasTurnedInHolesBefore) {
  SessionSetup setup = odd_setup();
  setup.path.bit = plate_bit(11.0, 0.7, 41.0, 1.0 / 3.0);
  setup.path.bit.width_along = Vec3(2.0, -1.0, 2.0) / 3.0;
  const Vec3 axis = Vec3(1.0, 2.0, -3.0).normalized(), side = any_perpendicular(axis);
  const Vec3 turned = axis.cross(side);
  const Pose first{Vec3(0.1, 0.2, 1.0 / 7.0), axis, side};
  setup.holes = {{setup.path.bit, {{first, {Vec3(9.1, 1e-17, 3.0), axis, side}, {Vec3(9.0, 0.1, 3.0), axis, turned}}}}};
  const Json json = to_json(setup);
  const Json& way = json["holes"][0]["ways"][0];
  EXPECT_EQ(way[0].size(), 9U);
  EXPECT_EQ(way[1].size(), 3U) << "as the one before";
  EXPECT_EQ(way[2].size(), 9U);
  const SessionSetup back = recorded_setup(record_setup(setup), "run.h5");
  EXPECT_EQ(back.path.bit, setup.path.bit);
  ASSERT_EQ(back.holes.size(), 1U);
  EXPECT_EQ(back.holes[0].bit, setup.path.bit);
  ASSERT_EQ(back.holes[0].ways[0].size(), 3U);
  for (std::size_t n = 0; n < 3; ++n) {
    const Pose &was = setup.holes[0].ways[0][n], &is = back.holes[0].ways[0][n];
    EXPECT_EQ(is.tip_mm, was.tip_mm);
    EXPECT_LT((is.axis - was.axis).norm(), 1e-15);
    EXPECT_LT((is.side - was.side).norm(), 1e-15);
  }
  EXPECT_EQ(to_json(back), json);

  const auto rejected = [&](const std::function<void(Json&)>& change) {
    Json bad = json;
    change(bad["holes"][0]["ways"][0]);
    EXPECT_THROW(read_session_setup(bad, "run.h5"), Error);
  };
  rejected([](Json& poses) { poses[0].erase(8); });
  rejected([](Json& poses) { poses[0] = Json{1.0, 2.0, 3.0, 0.0, 0.0, 1.0}; });
  rejected([](Json& poses) { poses[0][8] = "up"; });
  rejected([](Json& poses) { poses[0] = Json{1.0, 2.0, 3.0, 0.0, 0.0, 1.0, 0.0, 0.6, 0.8}; });
}

TEST(SessionSetup, OfRecordsWithoutARegionIsTheWholeBone) {
  Json json = to_json(odd_setup());
  json.erase("region_mm");
  EXPECT_FALSE(read_session_setup(json, "run.h5").region_mm);
  SessionSetup whole = odd_setup();
  whole.region_mm.reset();
  EXPECT_FALSE(to_json(whole).contains("region_mm"));
}

TEST(SessionSetup, OfADrillingAlongThePathHasNoWordOfIt) {
  SessionSetup setup = odd_setup();
  EXPECT_FALSE(to_json(setup)["options"].contains("follows_path"));
  EXPECT_TRUE(read_session_setup(to_json(setup), "run.h5").options.follows_path);
  setup.options.follows_path = false;
  EXPECT_EQ(to_json(setup)["options"]["follows_path"], false);
  EXPECT_FALSE(read_session_setup(to_json(setup), "run.h5").options.follows_path);
}

TEST(SessionSetup, HoldsTheEngineThatAutoCameTo) {
  SessionSetup setup = odd_setup();
  setup.engine = EngineKind::automatic;
  EXPECT_EQ(to_json(setup)["engine"], "voxel");
  setup.region_mm.reset();
  EXPECT_EQ(to_json(setup)["engine"], "ring");
}

TEST(SessionSetup, LeavesOutStopRulesThatNeverStop) {
  SessionSetup setup = odd_setup();
  setup.options.stop = {};
  Json json = to_json(setup);
  EXPECT_EQ(json["options"]["stop"].size(), 1U);
  SessionSetup back = read_session_setup(json, "run.h5");
  EXPECT_EQ(back.options.stop.thrust_n, kInfinite);
  EXPECT_EQ(back.options.stop.clearance_mm, -kInfinite);
  json["options"]["stop"]["thrust_n"] = nullptr;
  back = read_session_setup(json, "run.h5");
  EXPECT_EQ(back.options.stop.thrust_n, kInfinite);
}

TEST(SessionSetup, NamesFileAndKeyOfWhatIsWrong) {
  const auto error_of = [](const auto& change) -> std::string {
    Json json = to_json(odd_setup());
    change(json);
    try {
      read_session_setup(json, "run.h5");
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  const auto expect = [&](const std::string& part, const auto& change) {
    const std::string error = error_of(change);
    EXPECT_THAT(error, HasSubstr(part));
    EXPECT_THAT(error, HasSubstr("run.h5"));
  };
  EXPECT_EQ(error_of([](Json&) {}), "");
  expect("bone_hash", [](Json& json) { json.erase("bone_hash"); });
  expect("engine", [](Json& json) { json["engine"] = "steam"; });
  expect("jitter_seed", [](Json& json) { json["volume"]["jitter_seed"] = -1; });
  expect("hu_bits", [](Json& json) { json["volume"]["hu_bits"] = 9U; });
  expect("subdivision", [](Json& json) { json["volume"]["subdivision"] = "squares"; });
  expect("specific_cutting_energy_mpa", [](Json& json) { json["material"]["specific_cutting_energy_mpa"] = "hard"; });
  expect("states", [](Json& json) { json["options"]["states"] = 1; });
  expect("region_mm", [](Json& json) { json["region_mm"] = {1.0, 2.0}; });
  expect("region_mm", [](Json& json) { json["region_mm"][1][2] = "high"; });
  expect("region", [](Json& json) { json["region_mm"][1] = json["region_mm"][0]; });
  expect("follows_path", [](Json& json) { json["options"]["follows_path"] = 0; });
  expect("on_breach", [](Json& json) { json["options"]["stop"]["on_breach"] = 1; });
  expect("path", [](Json& json) { json["path"]["target_mm"] = json["path"]["entry_mm"]; });
  EXPECT_THROW(recorded_setup({}, "run.h5"), Error);
  EXPECT_THROW(recorded_setup({{"session", "{"}}, "run.h5"), Error);
}

}  // namespace
}  // namespace spinaltap
