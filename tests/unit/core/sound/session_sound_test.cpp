#include "core/sound/session_sound.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "core/base/error.h"

namespace spinaltap {
namespace {

RecordedCycle cutting_at(double time_s) {
  RecordedCycle cycle;
  cycle.time_s = time_s;
  cycle.thrust_n = 60.0;
  cycle.torque_n_mm = 30.0;
  cycle.tip_density_g_cm3 = 1.4;
  return cycle;
}

TEST(SessionSound, HasASampleForEachMomentOfTheSessionWhateverItsCycles) {
  for (const double dt_s : {0.01, 0.001, 1.0 / 3000.0, 1e-5}) {
    SessionSound sound(SessionSetup{});
    std::vector<float> samples;
    for (int n = 0; n * dt_s <= 0.5; ++n) sound.add(cutting_at(n * dt_s), samples);
    EXPECT_NEAR(static_cast<double>(samples.size()), 24000.0, 1.0 + dt_s * 48000.0) << dt_s;
  }
}

TEST(SessionSound, IsThatOfTheDrillWithTheCyclesForces) {
  SessionSetup setup;
  setup.options.spindle.rpm = 900.0;
  SessionSound session(setup);
  std::vector<float> samples;
  session.add(cutting_at(0.0), samples);
  RecordedCycle off = cutting_at(0.25);
  off.spindle_on = 0;
  session.add(off, samples);
  session.add(cutting_at(0.5), samples);
  DrillSound drill;
  std::vector<float> same(24000);
  drill.set({900.0, 60.0, 30.0, 1.4});
  drill.render(std::span(same).first(12000));
  drill.set({0.0, 60.0, 30.0, 1.4});
  drill.render(std::span(same).subspan(12000));
  EXPECT_TRUE(samples == same);
  // Live, the cycle itself tells the same.
  SessionSound live(setup);
  std::vector<float> heard;
  Cycle cycle;
  cycle.force.thrust_n = 60.0;
  cycle.force.torque_n_mm = 30.0;
  cycle.force.tip_density_g_cm3 = 1.4;
  live.add(cycle, heard);
  cycle.time_s = 0.25;
  cycle.input.spindle_on = false;
  live.add(cycle, heard);
  cycle.time_s = 0.5;
  live.add(cycle, heard);
  EXPECT_TRUE(heard == same);
}

TEST(SessionSound, TakesEdgesAndDroopFromTheSetup) {
  SessionSetup setup;
  EXPECT_EQ(SessionSound(setup).drill().options().edges, 2);
  setup.path.bit.shape = BitShape::round_burr;
  EXPECT_EQ(SessionSound(setup).drill().options().edges, 8);
  EXPECT_EQ(SessionSound(setup, {.edges = 5}).drill().options().edges, 5);
  setup.options.compliance.is_on = true;
  setup.options.compliance.stall_n_mm = 500.0;
  setup.options.compliance.spin_up_s = 0.2;
  EXPECT_EQ(SessionSound(setup).drill().options().droop_per_n_mm, 0.002);
  EXPECT_EQ(SessionSound(setup).drill().options().spin_up_s, 0.2);
}

TEST(SessionSound, RejectsTimesThatGoBackOrHaveNoEnd) {
  SessionSound sound(SessionSetup{});
  std::vector<float> samples;
  sound.add(cutting_at(0.1), samples);
  for (const double bad : {0.05, -1.0, 3601.0, 1e30, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW(sound.add(cutting_at(bad), samples), Error) << bad;
  }
  EXPECT_EQ(samples.size(), 4800U);
  RecordedCycle bad = cutting_at(0.2);
  bad.thrust_n = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(sound.add(bad, samples), Error);
}

}  // namespace
}  // namespace spinaltap
