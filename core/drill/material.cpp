#include "core/drill/material.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"

namespace spinaltap {

double Material::density_g_cm3(double hu) const { return std::max(0.0, density_at_0_hu + density_per_hu * hu); }

double Material::pressure_mpa(double hu) const {
  return pressure_at_1_g_cm3 * std::pow(density_g_cm3(hu), pressure_exponent);
}

void check_material(const Material& material) {
  const auto at_least = [](double value, double lowest, double highest, const char* what) {
    if (!(value >= lowest && value <= highest)) {
      fail("material: expected ", what, " from ", lowest, " to ", highest, ", found ", value);
    }
  };
  at_least(material.density_at_0_hu, -1.0, 2.0, "density_at_0_hu (g/cm3)");
  at_least(material.density_per_hu, 1e-6, 0.1, "density_per_hu (g/cm3)");
  at_least(material.pressure_at_1_g_cm3, 0.0, 1e3, "pressure_at_1_g_cm3 (MPa)");
  at_least(material.pressure_exponent, 0.0, 4.0, "pressure_exponent");
}

PressureTable::PressureTable(const Material& material) : units_(65536) {
  check_material(material);
  // No bone resists with more (2 GPa); a step that removes 2^32 such points still sums within 63 bits.
  constexpr double kHighestUnits = 0x1.0p31;
  for (std::size_t i = 0; i < units_.size(); ++i) {
    const double hu = static_cast<double>(i) - kOffset;
    units_[i] = std::llround(std::min(material.pressure_mpa(hu) / kUnitMpa, kHighestUnits));
  }
}

}  // namespace spinaltap
