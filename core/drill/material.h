#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace spinaltap {

/// How hard bone is to drill, from its CT number: a linear law for its density and a power law for the pressure that
/// thrust must overcome. The numbers and their sources are in data/materials/.
struct Material {
  double density_at_0_hu = 0.05;     ///< g/cm³
  double density_per_hu = 0.00105;   ///< g/cm³ per HU
  double pressure_at_1_g_cm3 = 6.0;  ///< MPa (N/mm²), of the thrust over the section cut
  double pressure_exponent = 2.0;    ///< of the density in g/cm³

  /// Density, g/cm³, never below 0.
  double density_g_cm3(double hu) const;
  /// Thrust over section, MPa, which is also the work of cutting, N·mm per mm³.
  double pressure_mpa(double hu) const;
};

/// Refuses values that are not finite, and laws by which denser bone would be easier to drill.
void check_material(const Material& material);

/// A material's pressure for every CT number, in whole units, so that a sum over points does not depend on its order.
class PressureTable {
 public:
  static constexpr double kUnitMpa = 1e-6;

  explicit PressureTable(const Material& material);

  /// Pressure in units of kUnitMpa.
  std::int64_t units(std::int16_t hu) const {
    const int index = hu + kOffset;
    return units_[static_cast<std::size_t>(index)];
  }

 private:
  static constexpr int kOffset = 32768;
  std::vector<std::int64_t> units_;
};

}  // namespace spinaltap
