// The cutting model against what others measured; through the simulation of blocks and plates. docs/forces.md has the
// sources.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "tests/unit/core/force/felt_run.h"

namespace spinaltap {
namespace {

using test::FeltBit;

/// Surgical twist drills: 118 degrees, a web of 0.16 of the diameter.
DrillBit surgical_drill(double diameter_mm) { return twist_drill(diameter_mm, 60.0, 118.0, 0.16 * diameter_mm); }

struct Felt {
  double mean_thrust_n = 0.0, mean_torque_n_mm = 0.0;  ///< between two depths
  double min_thrust_n = 1e9, max_thrust_n = 0.0;       ///< there; everywhere
};

/// Drills bone of a density at each depth; means over depths from `from_mm` to `to_mm`.
Felt drill(const DrillBit& bit, const Spindle& spindle, double feed_mm_s, double length_mm, double from_mm,
           double to_mm, const std::function<double(double)>& density_g_cm3) {
  const Material material;
  PointVolume volume(test::askew_path(length_mm + 2.0), {.radius_mm = 2.5, .spacing_mm = 0.1});
  test::fill_density(volume, material, [&](const Vec3& p) { return density_g_cm3(p.z()); });
  FeltBit felt(volume, bit, material, spindle);
  Felt sum;
  int count = 0;
  felt.drill(Vec3(0.3, 0.2, -0.5), length_mm, feed_mm_s * test::kCycleS, [&](double z_mm, const DrillForce& force) {
    sum.max_thrust_n = std::max(sum.max_thrust_n, force.thrust_n);
    if (z_mm < from_mm || z_mm > to_mm) return;
    ++count;
    sum.mean_thrust_n += force.thrust_n;
    sum.mean_torque_n_mm += force.torque_n_mm;
    sum.min_thrust_n = std::min(sum.min_thrust_n, force.thrust_n);
  });
  sum.mean_thrust_n /= count;
  sum.mean_torque_n_mm /= count;
  return sum;
}

TEST(CuttingModel, GiveMacAveliasThrustAndTorqueOfFemoralCortex) {
  // Human femoral shaft, 3.2 mm, 120 mm/min (MacAvelia 2012).
  struct Measured {
    double rpm, thrust_n, torque_n_mm;
  };
  for (const Measured& measured :
       {Measured{1000.0, 198.0, 186.0}, Measured{1250.0, 181.0, 158.0}, Measured{1500.0, 176.0, 140.0}}) {
    const Felt felt = drill(surgical_drill(3.2), {.rpm = measured.rpm}, 2.0, 5.0, 3.0, 5.0, [](double) { return 1.9; });
    std::printf("%.0f rpm: thrust %.1f N (%.0f), torque %.1f N mm (%.0f)\n", measured.rpm, felt.mean_thrust_n,
                measured.thrust_n, felt.mean_torque_n_mm, measured.torque_n_mm);
    EXPECT_NEAR(felt.mean_thrust_n, measured.thrust_n, 0.15 * measured.thrust_n);
    EXPECT_NEAR(felt.mean_torque_n_mm, measured.torque_n_mm, 0.15 * measured.torque_n_mm);
  }
}

TEST(CuttingModel, LeaveTheChiselEdgeMostOfTheThrust) {
  // Saha 1982: a point that leaves the chisel edge with little to do saved 45 % of the thrust; so it made more than
  // that.
  Material material;
  const CuttingResistance block = resistance_of_block(surgical_drill(3.2), material, test::hu_of(material, 1.9));
  const double share = block.chisel_n / block.thrust_n(120.0 / 1250.0);
  EXPECT_GT(share, 0.45);
  EXPECT_LT(share, 0.7);
  // Cortical bone's indentation hardness is some 400 to 600 N/mm².
  EXPECT_NEAR(material.chisel_pressure_mpa(test::hu_of(material, 1.9)), 500.0, 100.0);
}

TEST(CuttingModel, StayWithinTsaisRangesOfTheTrochanter) {
  // 1 to 1.5 N in cancellous bone, 0 to 50 N in cortical. Apparent density of a greater trochanter's cancellous bone:
  // 0.14 to 0.28 g/cm³; its cortex is a porous shell of some 1.5 mm, 1 g/cm³. 3.2 mm drill, 1 mm/s at 1,250 rpm.
  const Felt felt = drill(surgical_drill(3.2), {}, 1.0, 12.0, 5.0, 12.0, [](double z_mm) {
    if (z_mm < 0.5) return 0.0;
    return z_mm < 2.0 ? 1.0 : 0.17;
  });
  std::printf("trochanter: cancellous %.2f N, cortex up to %.1f N\n", felt.mean_thrust_n, felt.max_thrust_n);
  EXPECT_GT(felt.mean_thrust_n, 1.0);
  EXPECT_LT(felt.mean_thrust_n, 1.5);
  EXPECT_LT(felt.max_thrust_n, 50.0);
  EXPECT_GT(felt.max_thrust_n, 25.0);  // the cortex is felt
}

TEST(CuttingModel, StayWithinPowersRangeOfPigsVertebrae) {
  // 0.6 to 29.6 N. Cancellous bone of 0.18 to 0.5 g/cm³ in a shell of 0.4 mm, porous: 1.0 g/cm³. 2.5 mm drill.
  for (const double density : {0.18, 0.35, 0.5}) {
    const Felt felt = drill(surgical_drill(2.5), {}, 1.0, 8.0, 3.5, 8.0, [&](double z_mm) {
      if (z_mm < 0.5) return 0.0;
      return z_mm < 0.9 ? 1.0 : density;
    });
    std::printf("vertebra of %.2f g/cm3: cancellous %.2f N, shell up to %.1f N\n", density, felt.mean_thrust_n,
                felt.max_thrust_n);
    EXPECT_GT(felt.min_thrust_n, 0.6);
    EXPECT_LT(felt.max_thrust_n, 29.6);
    EXPECT_GT(felt.max_thrust_n, 2.0 * felt.mean_thrust_n);  // the shell is felt
  }
}

TEST(CuttingModel, ThrustRisesWithFeedDiameterAndDensityAndFallsWithSpeed) {
  const auto thrust_n = [](double diameter_mm, double density, double feed_mm_s, double rpm) {
    Material material;
    return resistance_of_block(surgical_drill(diameter_mm), material, test::hu_of(material, density))
        .thrust_n(feed_mm_s * 60.0 / rpm);
  };
  const double usual_n = thrust_n(3.0, 1.0, 1.0, 1250.0);
  EXPECT_GT(thrust_n(4.0, 1.0, 1.0, 1250.0), usual_n);
  EXPECT_GT(thrust_n(3.0, 1.2, 1.0, 1250.0), usual_n);
  EXPECT_GT(thrust_n(3.0, 1.0, 2.0, 1250.0), usual_n);
  EXPECT_LT(thrust_n(3.0, 1.0, 1.0, 2500.0), usual_n);
}

}  // namespace
}  // namespace spinaltap
