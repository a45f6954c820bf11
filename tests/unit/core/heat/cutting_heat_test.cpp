// Compiled with optimisation: long loops of its own.

#include "core/heat/cutting_heat.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/base/error.h"
#include "core/files/thermal_bone_file.h"
#include "core/points/material.h"
#include "tests/support/test_kind.h"

namespace spinaltap {
namespace {

/// What stays below the cut, by finite volumes: a chip of thickness 1 is swept off at speed 1, its boundary heated
/// evenly; what lies behind the boundary is gone with its heat. Diffusivity 1 / (4 Y).
double swept_share(double y, std::size_t per_chip) {
  const double diffusivity = 0.25 / y;
  const double depth = 1.0 + 8.0 * std::sqrt(diffusivity) + 1.0;
  const double cell = 1.0 / static_cast<double>(per_chip);
  const auto cells = static_cast<std::size_t>(depth / cell);
  std::vector<double> heat(cells, 0.0), next(cells);
  std::size_t gone = 0;
  // Each cell is heated until it is swept; its heat then goes with the chip.
  const double dwell = cell;
  const auto steps = static_cast<std::size_t>(std::ceil(dwell * diffusivity / (0.25 * cell * cell))) + 1;
  const double dt = dwell / static_cast<double>(steps);
  const double number = diffusivity * dt / (cell * cell);
  for (; gone < per_chip; ++gone) {
    for (std::size_t step = 0; step < steps; ++step) {
      heat[gone] += dt;
      for (std::size_t n = gone; n < cells; ++n) {
        const double before = n > gone ? heat[n - 1] : heat[n];
        const double after = n + 1 < cells ? heat[n + 1] : heat[n];
        next[n] = heat[n] + number * (before - 2.0 * heat[n] + after);
      }
      heat.swap(next);
    }
  }
  double stays = 0.0;
  for (std::size_t n = gone; n < cells; ++n) stays += heat[n];
  return stays;
}

CuttingState femoral_cortex(double rpm) {
  // MacAvelia 2012, as drilling.csv has it: 3.2 mm, 120 mm/min.
  return {.torque_n_mm = 157.8, .thrust_n = 180.6, .rpm = rpm, .feed_mm_per_turn = 120.0 / rpm, .density_g_cm3 = 1.9};
}

SLOW_TESTS("ShearPlaneShare.IsWhatASweptLayerLeavesBehind");

TEST(ShearPlaneShare, IsWhatASweptLayerLeavesBehind) {
  // Twice the value of the finer cells less that of the coarser: their error is of first order.
  for (const double y : {0.05, 0.3, 1.0, 3.0}) {
    const double share = shear_plane_share(y);
    EXPECT_NEAR(2.0 * swept_share(y, 120) - swept_share(y, 60), share, 0.01 * share) << y;
  }
}

TEST(ShearPlaneShare, FallsSmoothlyFromOneTowardsNothing) {
  EXPECT_EQ(shear_plane_share(0.0), 1.0);
  EXPECT_NEAR(shear_plane_share(0.99999e-4), shear_plane_share(1.00001e-4), 2e-6);
  EXPECT_NEAR(shear_plane_share(19.9999), shear_plane_share(20.0001), 1e-6);
  double last = 1.0;
  for (double y = 1e-6; y < 1e4; y *= 1.3) {
    const double share = shear_plane_share(y);
    EXPECT_LT(share, last);
    EXPECT_GT(share, 0.0);
    last = share;
  }
  EXPECT_TRUE(std::isnan(shear_plane_share(-1.0)));
}

TEST(CuttingHeat, HasThePowerOfTorqueAndThrust) {
  const CuttingHeat heat = cutting_heat(shipped_thermal_bone(), 3.2, femoral_cortex(1250.0));
  EXPECT_NEAR(heat.power_w, 0.1578 * 2.0 * std::numbers::pi * 1250.0 / 60.0 + 180.6 * 0.002, 1e-9);
  // Speed of the lip at two thirds of the radius, half the feed, over the diffusivity.
  EXPECT_NEAR(heat.peclet, (2.0 * std::numbers::pi * 1250.0 / 60.0 * 3.2 / 3.0) * 0.048 / (5.5e-4 / 2.2625e-3), 1e-9);
  EXPECT_NEAR(heat.bone_w, heat.bone_share * heat.power_w, 1e-12);
  EXPECT_GT(heat.bone_share, 0.02);
  EXPECT_LT(heat.bone_share, 0.1);
}

TEST(CuttingHeat, OfAMillimetreFallsWithTheFeedAndRisesWithTheSpeed) {
  const ThermalBone bone = shipped_thermal_bone();
  const Material material;
  const auto heat_per_mm = [&](double feed_mm_s, double rpm) {
    const double feed_mm = 60.0 * feed_mm_s / rpm;
    // Torque as the cutting model has it.
    const double torque = 500.0 * std::pow(feed_mm / material.reference_feed_mm, 1.0 - material.feed_exponent);
    return cutting_heat(bone, 3.2, {torque, 0.0, rpm, feed_mm, 1.8}).bone_w / feed_mm_s;
  };
  EXPECT_LT(heat_per_mm(2.0, 1000.0), heat_per_mm(1.0, 1000.0));
  EXPECT_LT(heat_per_mm(1.0, 1000.0), heat_per_mm(0.5, 1000.0));
  EXPECT_GT(heat_per_mm(1.0, 2000.0), heat_per_mm(1.0, 1000.0));
}

TEST(CuttingHeat, IsNothingWhereNothingTurnsOrIsKnown) {
  const ThermalBone bone;
  EXPECT_EQ(cutting_heat(bone, 3.0, {100.0, 50.0, 0.0, 0.1, 1.0}).bone_w, 0.0);
  EXPECT_EQ(cutting_heat(bone, 3.0, {0.0, 0.0, 1000.0, 0.1, 1.0}).bone_w, 0.0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(cutting_heat(bone, 3.0, {nan, 1.0, 1000.0, 0.1, 1.0}).bone_w, 0.0);
}

TEST(ThermalBone, IsAsMeasuredAtBothDensitiesAndBetweenThem) {
  const ThermalBone bone = shipped_thermal_bone();
  EXPECT_NEAR(bone.at(1.81).conductivity_w_mm_k, 0.55e-3, 1e-12);
  EXPECT_NEAR(bone.at(1.81).capacity_j_mm3_k, 1810e-9 * 1250.0, 1e-12);
  EXPECT_NEAR(bone.at(0.0).conductivity_w_mm_k, 7e-4 * 4.184 * 0.1, 1e-7);
  EXPECT_NEAR(bone.at(0.2).capacity_j_mm3_k, 0.73 * 4.184e-3, 1e-6);
  EXPECT_NEAR(bone.at(1.005).conductivity_w_mm_k, 0.5 * (0.55e-3 + 0.2929e-3), 1e-12);
  EXPECT_EQ(bone.at(5.0).conductivity_w_mm_k, bone.at(1.81).conductivity_w_mm_k);
  // The code's own defaults are the file's.
  const ThermalBone built_in;
  EXPECT_EQ(built_in.cancellous.conductivity_w_mm_k, bone.cancellous.conductivity_w_mm_k);
  EXPECT_NEAR(built_in.cortical.capacity_j_mm3_k, bone.cortical.capacity_j_mm3_k, 1e-15);
  EXPECT_EQ(built_in.temperature_c, bone.temperature_c);
}

TEST(ThermalBone, RejectsWhatIsNone) {
  ThermalBone bone;
  bone.cortical_density_g_cm3 = 0.1;
  EXPECT_THROW(check_thermal_bone(bone), Error);
  bone = {};
  bone.cancellous.conductivity_w_mm_k = 0.0;
  EXPECT_THROW(check_thermal_bone(bone), Error);
  bone = {};
  bone.shear_angle_deg = 90.0;
  EXPECT_THROW(check_thermal_bone(bone), Error);
}

}  // namespace
}  // namespace spinaltap
