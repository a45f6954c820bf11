#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/ct/density_law.h"

namespace spinaltap {

/// How hard bone is to drill, from its CT number: a law for its density, and a power law of the density for the
/// pressure that thrust must overcome. The numbers of the power law and their sources are in data/materials/.
struct Material {
  DensityLaw density = {};
  double pressure_at_1_g_cm3 = 6.0;  ///< MPa (N/mm²), of the thrust over the section cut
  double pressure_exponent = 2.0;    ///< of the density in g/cm³

  /// Thrust over section, MPa, which is also the work of cutting, N·mm per mm³.
  double pressure_mpa(double hu) const;
};

/// Refuses values that are not finite, and laws by which denser bone would be easier to drill.
void check_material(const Material& material);

/// A material's pressure for each CT number of a range, in whole units, so that a sum over points does not depend on
/// its order.
class PressureTable {
 public:
  static constexpr double kUnitMpa = 1e-6;

  explicit PressureTable(const Material& material, std::int16_t lowest_hu = -32768, std::int16_t highest_hu = 32767);

  /// Pressure in units of kUnitMpa. `hu` must be in the range.
  std::int64_t units(std::int16_t hu) const {
    const int index = hu - lowest_hu_;
    return units_[static_cast<std::size_t>(index)];
  }
  std::size_t memory_bytes() const { return units_.size() * sizeof(units_[0]); }

 private:
  int lowest_hu_;
  std::vector<std::int64_t> units_;
};

}  // namespace spinaltap
