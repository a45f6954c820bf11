#include "core/drill/material.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"

namespace spinaltap {

double Material::pressure_mpa(double hu) const {
  return pressure_at_1_g_cm3 * std::pow(density.density_g_cm3(hu), pressure_exponent);
}

void check_material(const Material& material) {
  check_density_law(material.density);
  const auto at_least = [](double value, double lowest, double highest, const char* what) {
    if (!(value >= lowest && value <= highest)) {
      fail("material: expected ", what, " from ", lowest, " to ", highest, ", found ", value);
    }
  };
  at_least(material.pressure_at_1_g_cm3, 0.0, 1e3, "pressure_at_1_g_cm3 (MPa)");
  at_least(material.pressure_exponent, 0.0, 4.0, "pressure_exponent");
}

PressureTable::PressureTable(const Material& material, std::int16_t lowest_hu, std::int16_t highest_hu)
    : lowest_hu_(lowest_hu) {
  check_material(material);
  if (!(highest_hu >= lowest_hu)) fail("pressure: expected CT numbers in order, found ", lowest_hu, " to ", highest_hu);
  // No bone resists with more (2 GPa); a step that removes 2^32 such points still sums within 63 bits.
  constexpr double kHighestUnits = 0x1.0p31;
  for (int hu = lowest_hu; hu <= highest_hu; ++hu) {
    units_.push_back(std::llround(std::min(material.pressure_mpa(hu) / kUnitMpa, kHighestUnits)));
  }
  units_.shrink_to_fit();
}

}  // namespace spinaltap
