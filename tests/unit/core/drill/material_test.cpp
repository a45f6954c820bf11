#include "core/drill/material.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/base/error.h"

namespace spinaltap {
namespace {

TEST(Material, NeverGetsEasierToDrillAsItGetsDenser) {
  const Material material;
  const PressureTable table(material);
  for (int hu = -32767; hu <= 32767; ++hu) {
    ASSERT_GE(material.pressure_mpa(hu), material.pressure_mpa(hu - 1)) << hu;
    ASSERT_GE(table.units(static_cast<std::int16_t>(hu)), table.units(static_cast<std::int16_t>(hu - 1))) << hu;
  }
}

TEST(Material, FollowsItsLaw) {
  const Material material{{0.1, 0.001}, 5.0, 2.0};
  EXPECT_NEAR(material.pressure_mpa(900.0), 5.0, 1e-14);
  EXPECT_NEAR(material.pressure_mpa(1900.0), 20.0, 1e-13);
}

TEST(Material, TakesNoPressureWithoutDensity) {
  const Material material;
  EXPECT_EQ(material.pressure_mpa(-1000.0), 0.0);
  EXPECT_EQ(PressureTable(material).units(-32768), 0);
}

TEST(PressureTable, HoldsThePressureOfEveryNumberToHalfAUnit) {
  const Material material;
  const PressureTable table(material);
  for (int hu = -32768; hu <= 32767; ++hu) {
    const double pressure_mpa = material.pressure_mpa(hu);
    // 2^31 units, 2,147 MPa, are the most that it holds.
    if (pressure_mpa > 2147.0) break;
    ASSERT_NEAR(static_cast<double>(table.units(static_cast<std::int16_t>(hu))) * PressureTable::kUnitMpa, pressure_mpa,
                0.5001 * PressureTable::kUnitMpa)
        << hu;
  }
}

TEST(PressureTable, HoldsTheSameInAShorterRange) {
  const PressureTable all(Material{});
  const PressureTable some(Material{}, -200, 1500);
  for (std::int16_t hu = -200; hu <= 1500; ++hu) ASSERT_EQ(some.units(hu), all.units(hu)) << hu;
  EXPECT_EQ(some.memory_bytes(), 1701U * sizeof(std::int64_t));
}

TEST(PressureTable, ClampsSoThatNoSumOverflows) {
  // The strongest law allowed: infinite or nearly so for dense metal.
  const PressureTable table(Material{{2.0, 0.1}, 1e3, 4.0});
  EXPECT_EQ(table.units(32767), std::int64_t{1} << 31);
  EXPECT_LT(static_cast<double>(table.units(32767)) * 0x1.0p32, 0x1.00001p63);
}

TEST(Material, RefusesLawsThatMakeNoSense) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinite = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, infinite, -infinite, -1.5, 1e6}) {
    EXPECT_THROW(check_material({{bad, 0.001}, 6.0, 2.0}), Error) << bad;
    EXPECT_THROW(check_material({{0.05, bad}, 6.0, 2.0}), Error) << bad;
    EXPECT_THROW(check_material({{}, bad, 2.0}), Error) << bad;
    EXPECT_THROW(check_material({{}, 6.0, bad}), Error) << bad;
  }
  EXPECT_THROW(PressureTable(Material{{0.05, -0.001}, 6.0, 2.0}), Error);
  EXPECT_THROW(PressureTable(Material{}, 5, 4), Error);
  EXPECT_NO_THROW(check_material({}));
}

}  // namespace
}  // namespace spinaltap
