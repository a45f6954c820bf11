#include "core/points/material.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/base/error.h"

namespace spinaltap {
namespace {

/// Density equal to 0.1 g/cm³ at 0 HU, 1 at 900 HU, 2 at 1,900 HU.
Material round_numbers() {
  Material material;
  material.density = {0.1, 0.001};
  return material;
}

TEST(Material, NeverGetsEasierToDrillAsItGetsDenser) {
  const Material material;
  const PressureTable table(material);
  for (int hu = -32767; hu <= 32767; ++hu) {
    ASSERT_GE(material.cutting_energy_mpa(hu), material.cutting_energy_mpa(hu - 1)) << hu;
    ASSERT_GE(material.chisel_pressure_mpa(hu), material.chisel_pressure_mpa(hu - 1)) << hu;
    ASSERT_GE(material.contact_stiffness_n_mm(hu), material.contact_stiffness_n_mm(hu - 1)) << hu;
    ASSERT_GE(table.units(static_cast<std::int16_t>(hu)), table.units(static_cast<std::int16_t>(hu - 1))) << hu;
  }
}

TEST(Material, FollowsItsModel) {
  Material material = round_numbers();
  material.specific_cutting_energy_mpa = 5.0;
  material.cutting_exponent = 2.0;
  material.chisel_mpa = 7.0;
  material.chisel_exponent = 3.0;
  material.contact_n_mm = 11.0;
  material.contact_exponent = 1.0;
  EXPECT_NEAR(material.cutting_energy_mpa(900.0), 5.0, 1e-13);
  EXPECT_NEAR(material.cutting_energy_mpa(1900.0), 20.0, 1e-13);
  EXPECT_NEAR(material.chisel_pressure_mpa(1900.0), 56.0, 1e-12);
  EXPECT_NEAR(material.contact_stiffness_n_mm(1900.0), 22.0, 1e-12);
}

TEST(Material, TakesNoPressureWithoutDensity) {
  const Material material;
  EXPECT_EQ(material.cutting_energy_mpa(-1000.0), 0.0);
  EXPECT_EQ(material.chisel_pressure_mpa(-1000.0), 0.0);
  EXPECT_EQ(material.contact_stiffness_n_mm(-1000.0), 0.0);
  EXPECT_EQ(PressureTable(material).units(-32768), 0);
}

TEST(PressureTable, HoldsThePressureOfEveryNumberToHalfAUnit) {
  const Material material;
  const PressureTable table(material);
  constexpr double kMaxMpa = static_cast<double>(PressureTable::kMaxUnits) * PressureTable::kUnitMpa;
  int held = 0;
  for (int hu = -32768; hu <= 32767; ++hu) {
    const double pressure_mpa = material.cutting_energy_mpa(hu);
    if (pressure_mpa > kMaxMpa) break;
    ++held;
    ASSERT_NEAR(static_cast<double>(table.units(static_cast<std::int16_t>(hu))) * PressureTable::kUnitMpa, pressure_mpa,
                0.5001 * PressureTable::kUnitMpa)
        << hu;
  }
  EXPECT_GT(held, 32768 + 3071);  // all that CTs have
}

TEST(PressureTable, HoldsTheSameInAShorterRange) {
  const PressureTable all(Material{});
  const PressureTable some(Material{}, -200, 1500);
  for (std::int16_t hu = -200; hu <= 1500; ++hu) ASSERT_EQ(some.units(hu), all.units(hu)) << hu;
  EXPECT_EQ(some.memory_bytes(), 1701U * sizeof(std::int64_t));
}

TEST(PressureTable, ClampsSoThatNoSumOverflows) {
  // The strongest model allowed: infinite or nearly so for dense metal.
  Material strongest;
  strongest.density = {2.0, 0.1};
  strongest.specific_cutting_energy_mpa = 1e4;
  strongest.cutting_exponent = 4.0;
  EXPECT_EQ(PressureTable(strongest).units(32767), PressureTable::kMaxUnits);
  // As many points as a volume may have, in quarters.
  EXPECT_LT(4.0 * static_cast<double>(PressureTable::kMaxUnits) * 0x1.0p32, 0x1.0p63);
}

TEST(Material, RejectsModelsThatMakeNoSense) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinite = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, infinite, -infinite, -1.5, 1e7}) {
    for (double Material::*member :
         {&Material::specific_cutting_energy_mpa, &Material::cutting_exponent, &Material::reference_feed_mm,
          &Material::feed_exponent, &Material::lip_thrust_share, &Material::chisel_mpa, &Material::chisel_exponent,
          &Material::chisel_share, &Material::contact_n_mm, &Material::contact_exponent}) {
      Material material;
      material.*member = bad;
      EXPECT_THROW(check_material(material), Error) << bad;
    }
    Material material;
    material.density = {bad, 0.001};
    EXPECT_THROW(check_material(material), Error) << bad;
    material.density = {0.05, bad};
    EXPECT_THROW(check_material(material), Error) << bad;
  }
  Material falling;
  falling.density = {0.05, -0.001};
  EXPECT_THROW(PressureTable{falling}, Error);
  EXPECT_THROW(PressureTable(Material{}, 5, 4), Error);
  EXPECT_NO_THROW(check_material({}));
}

}  // namespace
}  // namespace spinaltap
