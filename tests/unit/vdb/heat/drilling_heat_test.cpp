#include "vdb/heat/drilling_heat.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>
#include <span>
#include <vector>

#include "core/base/error.h"
#include "core/files/thermal_bone_file.h"
#include "core/force/drill_forces.h"
#include "core/heat/hole_heat.h"
#include "tests/support/test_kind.h"

namespace spinaltap {
namespace {

constexpr double kHeatEntryMm = 0.0;
constexpr double kDrilledMm = 6.0;

/// A drilling of an even block below z = 0 along z, by the closed form of its forces.
struct BlockDrilling {
  double diameter_mm = 3.2;
  double feed_mm_s = 1.0;
  double rpm = 1250.0;
  double pilot_mm = 0.0;  ///< diameter of a hole that is there
  double hu = 1500.0;
  double peck_mm = 0.0;
  double pause_s = 0.0;  ///< after each peck
  double water_w_mm2_k = 0.0;
};

class HeatedBlock final : public HeatMedium {
 public:
  explicit HeatedBlock(const ThermalTissue& tissue) : tissue_(tissue) {}
  void tissues(std::span<const Vec3> points_mm, std::span<ThermalTissue> tissues) const override {
    for (std::size_t n = 0; n < points_mm.size(); ++n) {
      tissues[n] = points_mm[n].z() > kHeatEntryMm ? tissue_ : ThermalTissue{};
    }
  }

 private:
  ThermalTissue tissue_;
};

struct BlockHeat {
  std::vector<HeatStep> steps;
  ThermalTissue tissue;
  DrillBit bit;
};

BlockHeat heat_of(const BlockDrilling& drilling) {
  const ThermalBone thermal = shipped_thermal_bone();
  const Material material;
  BlockHeat heat;
  heat.bit = twist_drill(drilling.diameter_mm, 40.0, 118.0, 0.16 * drilling.diameter_mm);
  const double density = material.density.density_g_cm3(drilling.hu);
  heat.tissue = thermal.at(density);
  const double feed_mm = 60.0 * drilling.feed_mm_s / drilling.rpm;
  const CuttingResistance resistance = resistance_of_block(heat.bit, material, drilling.hu);
  // Only what the pilot hole left is cut, and the chisel edge meets nothing.
  const double left = 1.0 - std::pow(drilling.pilot_mm / drilling.diameter_mm, 2);
  const double thrust_n = drilling.pilot_mm > 0.0 ? 0.0 : resistance.thrust_n(feed_mm);
  const CuttingHeat cutting =
      cutting_heat(thermal, drilling.diameter_mm,
                   {left * resistance.torque_n_mm(feed_mm), thrust_n, drilling.rpm, feed_mm, density});
  const double dt_s = 0.01;
  double depth_mm = 0.0, next_pause_mm = drilling.peck_mm;
  while (depth_mm < kDrilledMm + wall_back_mm(heat.bit)) {
    depth_mm += drilling.feed_mm_s * dt_s;
    const bool cuts = depth_mm > wall_back_mm(heat.bit);
    heat.steps.push_back({{Vec3(0, 0, depth_mm), Vec3::UnitZ()}, dt_s, cuts ? cutting.bone_w : 0.0});
    if (drilling.peck_mm > 0.0 && depth_mm >= next_pause_mm) {
      next_pause_mm += drilling.peck_mm;
      for (double pause = 0.0; pause < drilling.pause_s; pause += dt_s) {
        heat.steps.push_back({{Vec3(0, 0, depth_mm), Vec3::UnitZ()}, dt_s, 0.0});
      }
    }
  }
  return heat;
}

/// The largest rise 0.5 mm from the wall half-way down: of the grid and live.
struct Rises {
  double grid_k = 0.0;
  double live_k = 0.0;
  double farther_k = 0.0;  ///< of the grid, 1 mm from the wall
  DrillingHeat result;
};

/// The mean around the hole: a wall of voxels is not round.
double max_around_k(const HeatGrid& grid, double radius_mm, double depth_mm) {
  double sum = 0.0;
  const int count = 32;
  for (int n = 0; n < count; ++n) {
    const double angle = 2.0 * std::numbers::pi * n / count;
    sum += grid.max_rise_k(Vec3(radius_mm * std::cos(angle), radius_mm * std::sin(angle), depth_mm));
  }
  return sum / count;
}

Rises rises_of(const BlockDrilling& drilling, double voxel_mm = 0.2) {
  const BlockHeat heat = heat_of(drilling);
  const HeatedBlock block(heat.tissue);
  HeatGrid grid(block, {.voxel_mm = voxel_mm,
                        .origin_mm = Vec3::Constant(0.5 * voxel_mm),
                        .wall_transfer_w_mm2_k = drilling.water_w_mm2_k});
  const double radius_mm = heat.bit.radius_mm();
  HoleHeat live({.radius_mm = radius_mm,
                 .length_mm = 30.0,
                 .wall_transfer_w_mm2_k = drilling.water_w_mm2_k,
                 .wall_conductivity_w_mm_k = heat.tissue.conductivity_w_mm_k});
  Rises rises;
  const double at_mm = 0.5 * kDrilledMm;
  std::vector<HeatStep> steps = heat.steps;
  steps.insert(steps.end(), 400, {steps.back().pose, 0.01, 0.0});
  rises.result = run_drilling_heat(grid, heat.bit, steps, {.step_s = 0.05, .max_rest_s = 0.0});
  rises.grid_k = max_around_k(grid, radius_mm + 0.5, at_mm);
  rises.farther_k = max_around_k(grid, radius_mm + 1.0, at_mm);
  for (std::size_t n = 0; n < steps.size(); ++n) {
    const HeatStep& step = steps[n];
    live.update(step.pose.tip_mm.z() - wall_back_mm(heat.bit), step.bone_w, step.dt_s, heat.tissue);
    if (n % 5 == 0) rises.live_k = std::max(rises.live_k, live.rise_k(at_mm));
  }
  return rises;
}

SLOW_TESTS("DrillingHeat.*");
WHOLE_RUNS("DrillingHeat.OfShortPecksWithLongPausesIsThatOfAFinerGrid", "DrillingHeat.OfTheClosedFormIsThatOfTheGrid");

TEST(DrillingHeat, OfTheClosedFormIsThatOfTheGrid) {
  const auto compare = [](const char* what, const BlockDrilling& drilling, double voxel_mm = 0.2) {
    const Rises rises = rises_of(drilling, voxel_mm);
    std::printf("%s: grid %.2f K, closed form %.2f K (%+.1f %%), 1 mm off %.2f K\n", what, rises.grid_k, rises.live_k,
                100.0 * (rises.live_k / rises.grid_k - 1.0), rises.farther_k);
    EXPECT_NEAR(rises.live_k, rises.grid_k, 0.05 * rises.grid_k) << what;
    EXPECT_LT(rises.farther_k, rises.grid_k) << what;
  };
  compare("3.2 mm, 1 mm/s", {});
  compare("3.2 mm, 0.5 mm/s", {.feed_mm_s = 0.5});
  // What the voxels at the wall are off by counts most where heat has gone the least way.
  compare("3.2 mm, 2 mm/s", {.feed_mm_s = 2.0}, 0.16);
  compare("4.5 mm, 1 mm/s", {.diameter_mm = 4.5});
  compare("water", {.water_w_mm2_k = 1e-3});
  compare("cancellous bone", {.hu = 200.0}, 0.16);
  compare("pecks of 2 mm", {.peck_mm = 2.0, .pause_s = 2.0});
  compare("pecks of 0.5 mm", {.peck_mm = 0.5, .pause_s = 2.0});
  compare("pecks of 3 mm, 10 s", {.peck_mm = 3.0, .pause_s = 10.0});
}

TEST(DrillingHeat, OfShortPecksWithLongPausesIsThatOfAFinerGrid) {
  const Rises rises = rises_of({.peck_mm = 1.0, .pause_s = 5.0}, 0.16);
  std::printf("pecks of 1 mm, 5 s: grid %.2f K, closed form %.2f K\n", rises.grid_k, rises.live_k);
  EXPECT_NEAR(rises.live_k, rises.grid_k, 0.05 * rises.grid_k);
}

TEST(DrillingHeat, HasThePublishedTrends) {
  const double usual_k = rises_of({}, 0.25).grid_k;
  // Higher feed cooler, faster turning hotter (Augustin 2008), a pilot hole, water and softer bone cooler.
  EXPECT_LT(rises_of({.feed_mm_s = 2.0}, 0.25).grid_k, usual_k);
  EXPECT_GT(rises_of({.rpm = 2500.0}, 0.25).grid_k, usual_k);
  EXPECT_LT(rises_of({.pilot_mm = 2.0}, 0.25).grid_k, usual_k);
  EXPECT_LT(rises_of({.water_w_mm2_k = 1e-3}, 0.25).grid_k, usual_k);
  EXPECT_LT(rises_of({.hu = 500.0}, 0.25).grid_k, usual_k);
  // Short pecks, against a pause before drilling that is as long in all.
  EXPECT_LT(rises_of({.peck_mm = 0.5, .pause_s = 2.0}, 0.25).grid_k, 0.9 * usual_k);
}

TEST(DrillingHeat, GivesTheWallItsPowerAndTellsHowMuchGotHot) {
  const BlockHeat heat = heat_of({.feed_mm_s = 0.5});
  const HeatedBlock block(heat.tissue);
  HeatGrid grid(block, {.voxel_mm = 0.25, .origin_mm = Vec3::Constant(0.125)});
  const DrillingHeat result = run_drilling_heat(grid, heat.bit, heat.steps);
  double given_j = 0.0;
  for (const HeatStep& step : heat.steps) given_j += step.bone_w * step.dt_s;
  EXPECT_NEAR(result.balance.given_j + result.balance.missed_j, given_j, 1e-9 * given_j);
  EXPECT_LT(result.balance.missed_j, 0.05 * given_j);
  EXPECT_NEAR(result.balance.in_bone_j + result.balance.drilled_j, result.balance.given_j, 1e-9 * given_j);
  EXPECT_TRUE(result.has_cooled);
  EXPECT_GT(result.hottest.rise_k, result.hottest_at_half.rise_k);
  EXPECT_GE(result.hot_0_mm3, result.hot_60_s_mm3);
  EXPECT_GT(result.hot_0_mm3, 0.0);
  const Vec3 at = result.hottest_at_half.at_mm;
  EXPECT_GE(std::hypot(at.x(), at.y()), heat.bit.radius_mm() + 0.5);
  EXPECT_THROW(run_drilling_heat(grid, plate_bit(10.0, 1.0, 20.0), heat.steps), Error);
  EXPECT_THROW(run_drilling_heat(grid, heat.bit, heat.steps, {.step_s = 0.0}), Error);
}

TEST(DrillingHeat, TakesARecordsCyclesAsTheyAre) {
  std::vector<RecordedCycle> cycles(3);
  for (RecordedCycle& cycle : cycles) {
    cycle.dt_s = 0.001;
    cycle.torque_n_mm = 100.0;
    cycle.thrust_n = 50.0;
    cycle.feed_mm_per_turn = 0.05;
    cycle.tip_density_g_cm3 = 1.2;
  }
  cycles[1].spindle_on = 0;
  const ThermalBone bone = shipped_thermal_bone();
  const DrillBit bit;
  const std::vector<HeatStep> steps = heat_steps(cycles, bit, 1250.0, bone);
  EXPECT_EQ(steps[0].bone_w, cutting_heat(bone, bit.diameter_mm, {100.0, 50.0, 1250.0, 0.05, 1.2}).bone_w);
  EXPECT_GT(steps[0].bone_w, 0.0);
  EXPECT_EQ(steps[1].bone_w, 0.0);
  EXPECT_EQ(steps[2].dt_s, 0.001);
}

}  // namespace
}  // namespace spinaltap
