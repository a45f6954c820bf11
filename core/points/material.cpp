#include "core/points/material.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"

namespace spinaltap {

double Material::cutting_energy_mpa(double hu) const {
  return specific_cutting_energy_mpa * std::pow(density.density_g_cm3(hu), cutting_exponent);
}

double Material::chisel_pressure_mpa(double hu) const {
  return chisel_mpa * std::pow(density.density_g_cm3(hu), chisel_exponent);
}

double Material::contact_stiffness_n_mm(double hu) const {
  return contact_n_mm * std::pow(density.density_g_cm3(hu), contact_exponent);
}

void check_material(const Material& material) {
  check_hu_to_density(material.density);
  const auto within = [](double value, double lowest, double highest, const char* what) {
    if (!(value >= lowest && value <= highest)) {
      fail("material: expected ", what, " from ", lowest, " to ", highest, ", found ", value);
    }
  };
  // Steel is cut with some 3,000 N·mm/mm³; an exponent below 0 would make denser bone easier to drill.
  within(material.specific_cutting_energy_mpa, 0.0, 1e4, "specific_cutting_energy_mpa");
  within(material.cutting_exponent, 0.0, 4.0, "cutting_exponent");
  within(material.reference_feed_mm, 1e-4, 10.0, "reference_feed_mm (per turn)");
  // From 1 on, a faster feed would take less torque.
  within(material.feed_exponent, 0.0, 0.99, "feed_exponent");
  within(material.lip_thrust_share, 0.0, 10.0, "lip_thrust_share");
  within(material.chisel_mpa, 0.0, 1e4, "chisel_mpa");
  within(material.chisel_exponent, 0.0, 4.0, "chisel_exponent");
  within(material.chisel_share, 0.0, 1.0, "chisel_share");
  within(material.contact_n_mm, 0.0, 1e6, "contact_n_mm");
  within(material.contact_exponent, 0.0, 4.0, "contact_exponent");
}

PressureTable::PressureTable(const Material& material, std::int16_t lowest_hu, std::int16_t highest_hu)
    : lowest_hu_(lowest_hu) {
  check_material(material);
  if (!(highest_hu >= lowest_hu)) fail("pressure: expected CT numbers in order, found ", lowest_hu, " to ", highest_hu);
  constexpr auto kMax = static_cast<double>(kMaxUnits);
  for (int hu = lowest_hu; hu <= highest_hu; ++hu) {
    units_.push_back(std::llround(std::min(material.cutting_energy_mpa(hu) / kUnitMpa, kMax)));
  }
  units_.shrink_to_fit();
}

}  // namespace spinaltap
