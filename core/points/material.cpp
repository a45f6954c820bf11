#include "core/points/material.h"

#include <algorithm>
#include <cmath>

#include "core/base/check_range.h"
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

Material with_forces_times(const Material& material, double factor) {
  if (!(factor > 0.0) || !std::isfinite(factor)) fail("forces: expected a factor above 0, found ", factor);
  Material scaled = material;
  scaled.specific_cutting_energy_mpa *= factor;
  scaled.chisel_mpa *= factor;
  return scaled;
}

void check_material(const Material& material) {
  check_hu_to_density(material.density);
  const auto within = [](double value, double lowest, double highest, const char* what) {
    check_range(value, lowest, highest, "material", what);
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
  // Above 45 degrees Merchant's shear plane closes at the chisel edge's rakes.
  within(material.lips.friction_deg, 0.0, 45.0, "friction_deg");
  within(material.lips.speed_exponent, 0.0, 1.0, "speed_exponent");
  within(material.lips.reference_rpm, 1.0, 1e6, "reference_rpm");
  within(material.lips.margin_pressure_share, 0.0, 1.0, "margin_pressure_share");
  within(material.lips.chip_torque_per_diameter, 0.0, 1.0, "chip_torque_per_diameter");
  for (const ForceSpread& spread : {material.thrust_spread, material.torque_spread}) {
    within(spread.median, 1e-3, 1e3, "median of a spread");
    within(spread.log_scale, 0.0, 5.0, "log_scale of a spread");
    within(spread.degrees, 1.0, 1000.0, "degrees_of_freedom of a spread");
    if (spread.degrees != std::floor(spread.degrees)) {
      fail("material: expected whole degrees_of_freedom of a spread, found ", spread.degrees);
    }
  }
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
