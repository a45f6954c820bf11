// The laws against closed forms: geometry of a drill, and the pressures on it.

#include "core/force/cutting_law.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/base/error.h"
#include "core/force/force_band.h"
#include "tests/unit/core/force/felt_run.h"

namespace spinaltap {
namespace {

constexpr double kLawHu = 1500.0, kLawFeedMm = 0.06;
constexpr double kDegreeOfLaw = std::numbers::pi / 180.0;

Material mechanistic() {
  Material material;
  material.density = {0.0, 0.001};
  material.law = CuttingLaw::mechanistic;
  return material;
}

/// With a chisel edge so narrow that there is hardly a web: it turns the rake of the innermost hundredth of the lips.
constexpr double kOfTheWeb = 3e-3;
DrillBit webless(double helix_deg, double point_deg = 118.0) {
  DrillBit bit = twist_drill(3.2, 50.0, point_deg, 0.002);
  bit.helix_deg = helix_deg;
  return bit;
}

double lips_thrust_n(const DrillBit& bit, const Material& material) {
  const CuttingResistance block = resistance_of_block(bit, material, kLawHu);
  return block.thrust_n(kLawFeedMm) - block.chisel_n;
}

TEST(CuttingLaws, PowerLawKnowsNeitherHelixNorWearNorDepthNorSpeed) {
  const Material material;
  DrillBit bit = webless(25.0);
  const CuttingResistance usual = resistance_of_block(bit, material, kLawHu);
  bit.helix_deg = 5.0;
  bit.wear_mm = 0.2;
  const CuttingResistance other = resistance_of_block(bit, material, kLawHu, 4000.0, 30.0);
  EXPECT_EQ(other.thrust_n(kLawFeedMm), usual.thrust_n(kLawFeedMm));
  EXPECT_EQ(other.torque_n_mm(kLawFeedMm), usual.torque_n_mm(kLawFeedMm));
  EXPECT_EQ(ToolLaw(bit, material).energy_factor(700.0), 1.0);
}

TEST(CuttingLaws, StraightFlutesCutWithARakeOfZero) {
  // Then the force along the cut is the table's energy, and off it the friction's tangent, all along the lips.
  Material material = mechanistic();
  material.lips.speed_exponent = 0.0;
  const DrillBit bit = webless(0.0);
  const ToolLaw law(bit, material);
  EXPECT_NEAR(law.energy_factor(1250.0), 1.0, 1e-3);
  EXPECT_NEAR(law.lip_thrust_share(),
              std::tan(material.lips.friction_deg * kDegreeOfLaw) * std::sin(59.0 * kDegreeOfLaw), kOfTheWeb);
}

TEST(CuttingLaws, WithoutAWebTheRakeIsTheHelixSeenAcrossTheLip) {
  // tan(rake) = r/R tan(helix) / sin(half the point's angle); summed up along the lip.
  const Material material = mechanistic();
  for (const double point_deg : {90.0, 118.0, 140.0}) {
    for (const double helix_deg : {10.0, 25.0, 35.0}) {
      const double friction = material.lips.friction_deg * kDegreeOfLaw, half = 0.5 * point_deg * kDegreeOfLaw;
      const auto cotangent = [&](double rake) {
        return 1.0 / std::tan(0.25 * std::numbers::pi - 0.5 * (friction - rake));
      };
      double torque = 0.0, thrust = 0.0;
      constexpr int kPieces = 100000;
      for (int n = 0; n < kPieces; ++n) {
        const double radius = (n + 0.5) / kPieces;
        const double rake = std::atan(radius * std::tan(helix_deg * kDegreeOfLaw) / std::sin(half));
        const double cut = cotangent(rake) / cotangent(0.0) * std::pow(radius, material.lips.speed_exponent) / kPieces;
        torque += 2.0 * radius * cut;
        thrust += cut * std::tan(friction - rake);
      }
      const double thinner = std::pow(std::sin(half) / std::sin(59.0 * kDegreeOfLaw), -material.feed_exponent);
      const ToolLaw law(webless(helix_deg, point_deg), material);
      EXPECT_NEAR(law.energy_factor(material.lips.reference_rpm), torque * thinner, 2e-3 * torque);
      EXPECT_NEAR(law.lip_thrust_share(), thrust * std::sin(half) / torque, kOfTheWeb) << point_deg << ' ' << helix_deg;
    }
  }
}

TEST(CuttingLaws, LipsPushAndTurnHarderWithLessHelixAndAWiderWeb) {
  const Material material = mechanistic();
  double before_n = 1e9;
  for (const double helix_deg : {5.0, 15.0, 25.0, 35.0}) {
    const double now_n = lips_thrust_n(webless(helix_deg), material);
    EXPECT_LT(now_n, before_n);
    before_n = now_n;
  }
  // The rake near the web lies far back: Saha's split point spares it.
  before_n = 0.0;
  for (const double web_mm : {0.1, 0.4, 0.8}) {
    const double now_n = resistance_of_block(twist_drill(3.2, 50.0, 118.0, web_mm), material, kLawHu).thrust_n(0.06);
    EXPECT_GT(now_n, before_n);
    before_n = now_n;
  }
}

TEST(CuttingLaws, AWornFlatIsPressedByWhatTheChiselEdgeIs) {
  const Material material = mechanistic();
  DrillBit bit = twist_drill(3.2, 50.0, 118.0, 0.5);
  const CuttingResistance sharp = resistance_of_block(bit, material, kLawHu);
  bit.wear_mm = 0.05;
  const CuttingResistance worn = resistance_of_block(bit, material, kLawHu);
  const double pressed_n = material.chisel_pressure_mpa(kLawHu) * 2.0 * 0.05 * (1.6 - 0.25);
  EXPECT_NEAR(worn.thrust_n(kLawFeedMm) - sharp.thrust_n(kLawFeedMm), pressed_n, 1e-9 * pressed_n);
  // Rubbing, on the flats' slope, at their mean radius.
  const double rubbed_n_mm =
      pressed_n * std::tan(material.lips.friction_deg * kDegreeOfLaw) / std::sin(59.0 * kDegreeOfLaw) * 0.5 * 1.85;
  EXPECT_NEAR(worn.torque_n_mm(kLawFeedMm) - sharp.torque_n_mm(kLawFeedMm), rubbed_n_mm, 1e-9 * rubbed_n_mm);
}

TEST(CuttingLaws, TorqueGrowsWithDepthByMarginsAndChipsAndThrustDoesNot) {
  const Material material = mechanistic();
  const DrillBit bit = twist_drill(3.2, 50.0, 118.0, 0.5);
  const CuttingResistance open = resistance_of_block(bit, material, kLawHu);
  const CuttingResistance deep = resistance_of_block(bit, material, kLawHu, 1250.0, 20.0);
  EXPECT_EQ(deep.thrust_n(kLawFeedMm), open.thrust_n(kLawFeedMm));
  const double wall_mpa = material.lips.margin_pressure_share * material.cutting_energy_mpa(kLawHu);
  const double margins_n_mm =
      std::tan(material.lips.friction_deg * kDegreeOfLaw) * wall_mpa * 2.0 * 0.08 * 3.2 * 20.0 * 1.6;
  const double chips_n_mm = open.torque_n_mm(kLawFeedMm) * material.lips.chip_torque_per_diameter * 20.0 / 3.2;
  EXPECT_NEAR(deep.torque_n_mm(kLawFeedMm) - open.torque_n_mm(kLawFeedMm), margins_n_mm + chips_n_mm, 1e-9);
}

TEST(CuttingLaws, SpeedHardensBoneByItsExponent) {
  const ToolLaw law(twist_drill(3.2, 50.0, 118.0, 0.5), mechanistic());
  EXPECT_NEAR(law.energy_factor(2500.0) / law.energy_factor(1250.0), std::pow(2.0, 0.06), 1e-12);
}

TEST(CuttingLaws, BurrsAndPlatesHaveNoFlutes) {
  const Material material = mechanistic();
  Material power = material;
  power.law = CuttingLaw::power;
  const DrillBit saw = plate_bit(10.0, 1.0, 60.0, 3.0);
  EXPECT_EQ(resistance_of_block(saw, material, kLawHu).thrust_n(0.02),
            resistance_of_block(saw, power, kLawHu).thrust_n(0.02));
  const DrillBit ball{4.0, 60.0, 0.0, BitShape::round_burr, 0.0, 2.0};
  EXPECT_EQ(resistance_of_block(ball, material, kLawHu, 1250.0, 30.0).rub_n_mm, 0.0);
  DrillBit bad = ball;
  bad.wear_mm = 0.1;
  EXPECT_THROW(ToolLaw(bad, material), Error);
}

TEST(CuttingLaws, MechanisticIsFeltInEveryCycleOfAnEvenBlock) {
  Material material;
  material.law = CuttingLaw::mechanistic;
  DrillBit bit = twist_drill(3.2, 50.0, 118.0, 0.5);
  bit.wear_mm = 0.02;
  PointVolume volume = test::block(9.0, 2.8, 0.1, test::kFeltHu);
  const Spindle spindle{.rpm = 900.0};
  test::FeltBit felt(volume, bit, material, spindle);
  const double feed = test::feed_mm(0.002, spindle);
  int seen = 0;
  felt.drill(Vec3(0.0, 0.0, -0.3), 7.0, 0.002, [&](double z_mm, const DrillForce& force) {
    if (z_mm < 4.0) return;
    ++seen;
    const CuttingResistance block = resistance_of_block(bit, material, test::kFeltHu, spindle.rpm, z_mm);
    EXPECT_NEAR(force.thrust_n, block.thrust_n(feed), 0.01 * block.thrust_n(feed)) << z_mm;
    // Margins rub on what was cut: of the tip's cone a third of its length's section.
    const double cut_mm = z_mm - 2.0 / 3.0 * bit.tip_length_mm;
    const double rubbed_n_mm = resistance_of_block(bit, material, test::kFeltHu, spindle.rpm, cut_mm).rub_n_mm;
    const double torque_n_mm = block.torque_n_mm(feed) - block.rub_n_mm + rubbed_n_mm;
    EXPECT_NEAR(force.torque_n_mm, torque_n_mm, 0.01 * torque_n_mm) << z_mm;
    const ForceBand band(material);
    EXPECT_EQ(force.thrust_band_n.low, band.thrust_n(force.thrust_n).low);
    EXPECT_EQ(force.torque_band_n_mm.high, band.torque_n_mm(force.torque_n_mm).high);
  });
  EXPECT_GT(seen, 100);
}

TEST(ForceBands, AreQuantilesOfStudentsTOfTheLogarithm) {
  Material material;
  material.thrust_spread = {0.5, 0.8, 9.0};
  material.torque_spread = {2.0, 0.0, 4.0};
  const ForceBand band(material);
  // 1.833113: 95 % of Student's t with 9 degrees of freedom.
  EXPECT_NEAR(band.thrust_n(10.0).low, 5.0 * std::exp(-0.8 * 1.833113), 1e-5);
  EXPECT_NEAR(band.thrust_n(10.0).high, 5.0 * std::exp(0.8 * 1.833113), 1e-4);
  EXPECT_EQ(band.torque_n_mm(10.0).low, 20.0);
  EXPECT_EQ(band.torque_n_mm(10.0).high, 20.0);
  EXPECT_TRUE(band.is_known());
  material.thrust_spread = ForceSpread{};
  EXPECT_FALSE(ForceBand(material).is_known());
  material.thrust_spread.log_scale = -1.0;
  EXPECT_THROW(ForceBand{material}, Error);
  material.thrust_spread = {1.0, 1.0, 2.5};
  EXPECT_THROW(ForceBand{material}, Error);
}

TEST(ForceBands, GrowWithTheForcesThatAMaterialIsScaledTo) {
  const Material material;
  const Material harder = with_forces_times(material, 3.0);
  const DrillBit bit = twist_drill(3.2, 50.0, 118.0, 0.5);
  const double thrust_n = resistance_of_block(bit, material, kLawHu).thrust_n(kLawFeedMm);
  EXPECT_NEAR(resistance_of_block(bit, harder, kLawHu).thrust_n(kLawFeedMm), 3.0 * thrust_n, 1e-12 * thrust_n);
  EXPECT_EQ(harder.contact_n_mm, material.contact_n_mm);
  EXPECT_THROW(with_forces_times(material, 0.0), Error);
}

}  // namespace
}  // namespace spinaltap
