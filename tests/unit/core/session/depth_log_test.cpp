#include "core/session/depth_log.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "tests/support/nan.h"

namespace spinaltap {
namespace {

using test::kNan;

/// A cycle of 1 ms with the tip at a depth.
Cycle cycle_at(double depth_mm) {
  Cycle cycle;
  cycle.depth_mm = depth_mm;
  cycle.input.dt_s = 0.001;
  return cycle;
}

TEST(DepthLog, EndsRowsAtWholeStepsWhateverTheAdvance) {
  for (const double advance_mm : {0.01, 0.007, 0.13}) {
    DepthLog log(0.5, Material(), 10.0);
    const int count = static_cast<int>(std::lround(4.0 / advance_mm));
    for (int n = 0; n <= count; ++n) log.add(cycle_at(-1.0 + n * advance_mm), 1e-5);
    const std::vector<DepthRow> rows = log.finish();
    std::size_t cycles = 0;
    for (std::size_t n = 0; n < rows.size(); ++n) {
      cycles += rows[n].cycles;
      if (n + 1 == rows.size()) break;
      EXPECT_GE(rows[n].depth_mm, -1.0 + 0.5 * static_cast<double>(n + 1) - 1e-6);
      EXPECT_LT(rows[n].depth_mm, -1.0 + 0.5 * static_cast<double>(n + 1) + advance_mm);
    }
    EXPECT_EQ(cycles, static_cast<std::size_t>(count));  // the first puts the bit
    EXPECT_NEAR(static_cast<double>(rows.size()), count * advance_mm / 0.5, 1.0);
    EXPECT_NEAR(rows.front().cycles_per_s, 1e5, 1e-6);
  }
}

TEST(DepthLog, CountsWhatHappensWhileTheBitDrawsBackInTheRowOfItsDeepestPlace) {
  DepthLog log(1.0, Material(), 10.0);
  for (const double depth_mm : {0.0, 0.6, 1.1, 0.2, 0.1, 0.9, 1.8, 2.3}) {
    Cycle cycle = cycle_at(depth_mm);
    cycle.step.removed = 2;
    cycle.step.removed_hu = 600;
    log.add(cycle, kNan);
  }
  const std::vector<DepthRow> rows = log.finish();
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].cycles, 2U);
  EXPECT_EQ(rows[0].depth_mm, 1.1);
  EXPECT_EQ(rows[0].removed, 6U);  // with what the bit took where it was put
  EXPECT_EQ(rows[1].cycles, 5U);
  EXPECT_EQ(rows[1].depth_mm, 2.3);
  EXPECT_EQ(rows[1].hu, 300.0);
  EXPECT_TRUE(std::isnan(rows[1].cycles_per_s));
}

TEST(DepthLog, MakesMeansOverTimeAndKeepsTheMinClearanceAndTheLastState) {
  DepthLog log(1.0, Material(), 10.0);
  log.add(cycle_at(0.0), 1.0);
  Cycle slow = cycle_at(0.5);
  slow.input.dt_s = 0.003;
  slow.force.thrust_n = 40.0;
  slow.force.torque_n_mm = 8.0;
  slow.force.lateral_n = Vec3(3.0, 0.0, -4.0);
  slow.clearance.outer_mm = 0.5;
  slow.state = DrillState::outer_cortical;
  log.add(slow, 1.0);
  Cycle quick = cycle_at(1.0);
  quick.clearance.outer_mm = 0.7;
  quick.clearance.canal_mm = -0.2;
  quick.state = DrillState::cancellous;
  log.add(quick, 1.0);
  const std::vector<DepthRow> rows = log.finish();
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_NEAR(rows[0].thrust_n, 30.0, 1e-12);
  EXPECT_NEAR(rows[0].torque_n_mm, 6.0, 1e-12);
  const ForceBand band{Material()};
  EXPECT_EQ(rows[0].thrust_band_n.high, band.thrust_n(rows[0].thrust_n).high);
  EXPECT_EQ(rows[0].torque_band_n_mm.low, band.torque_n_mm(rows[0].torque_n_mm).low);
  EXPECT_NEAR(rows[0].lateral_n, 3.75, 1e-12);
  EXPECT_EQ(rows[0].outer_mm, 0.5);
  EXPECT_EQ(rows[0].canal_mm, -0.2);
  EXPECT_EQ(rows[0].state, DrillState::cancellous);
  EXPECT_TRUE(std::isnan(rows[0].hu));
}

TEST(DepthLog, KeepsTheMaxTemperatureOfARow) {
  DepthLog log(1.0, Material(), 10.0);
  log.add(cycle_at(0.0), kNan);
  for (const double temperature_c : {37.0, 44.5, 41.0}) {
    Cycle cycle = cycle_at(0.3);
    cycle.heat.temperature_c = temperature_c;
    log.add(cycle, kNan);
  }
  log.add(cycle_at(1.0), kNan);
  log.add(cycle_at(2.0), kNan);
  const std::vector<DepthRow> rows = log.finish();
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].temperature_c, 44.5);
  EXPECT_TRUE(std::isnan(rows[1].temperature_c)) << "a session without heat";
}

TEST(DepthLog, GoesOnAfterPosesWithoutADepthAndAfterJumps) {
  DepthLog log(0.1, Material(), 1.0);
  for (const double depth_mm : {kNan, 0.0, kNan, 30.0, 30.05, 30.11}) log.add(cycle_at(depth_mm), 1.0);
  const std::vector<DepthRow> rows = log.finish();
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].depth_mm, 30.0);
  EXPECT_EQ(rows[1].depth_mm, 30.11);
}

TEST(DepthLog, RejectsALogStepThatIsNotAboveZero) {
  for (const double step_mm : {0.0, -1.0, kNan}) EXPECT_THROW(DepthLog(step_mm, Material(), 10.0), Error);
}

TEST(DrillLog, HasUnitsInItsHeadAndEmptyFieldsWhereNothingIsKnown) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  DepthRow nothing;
  nothing.depth_mm = -2.9;
  nothing.cycles = 100;
  nothing.hu = nothing.density_g_cm3 = kNan;
  nothing.outer_mm = nothing.canal_mm = kInfinity;
  nothing.temperature_c = kNan;
  nothing.cycles_per_s = 1e6;
  DepthRow bone;
  bone.depth_mm = 0.1;
  bone.cycles = 100;
  bone.removed = 12;
  bone.tested = 340;
  bone.hu = 300.5;
  bone.density_g_cm3 = 0.365;
  bone.thrust_n = 1.25;
  bone.torque_n_mm = 3.5;
  bone.thrust_band_n = {0.5, 2.5};
  bone.torque_band_n_mm = {1.5, 7.5};
  bone.lateral_n = 0.25;
  bone.contact_n = 0.75;
  bone.state = DrillState::outer_cortical;
  bone.outer_mm = 2.25;
  bone.canal_mm = -0.5;
  bone.temperature_c = 41.5;
  bone.cycles_per_s = kNan;
  EXPECT_EQ(log_csv({nothing, bone}),
            "depth_mm,cycles,removed_points,tested_points,mean_hu,mean_density_g_cm3,mean_thrust_n,mean_torque_n_mm,"
            "p05_thrust_n,p95_thrust_n,p05_torque_n_mm,p95_torque_n_mm,mean_lateral_n,mean_contact_n,state,min_"
            "clearance_outer_mm,min_clearance_canal_mm,max_temperature_c,cycles_per_s\n"
            "-2.9,100,0,0,,,0,0,0,0,0,0,0,0,initial,,,,1000000\n"
            "0.1,100,12,340,300.5,0.365,1.25,3.5,0.5,2.5,1.5,7.5,0.25,0.75,outer cortical,2.25,-0.5,41.5,\n");
}

}  // namespace
}  // namespace spinaltap
