#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/ct/hu_to_density.h"

namespace spinaltap {

/// How thrust and torque follow from the energy of cutting: docs/forces.md.
enum class CuttingLaw : std::uint8_t {
  power,       ///< the lips' thrust is one share of the force along their cut, whatever the drill
  mechanistic  ///< chips by the rake and the speed at each radius of the lips, worn flanks, margins and chips in flutes
};

/// What the mechanistic law knows besides. Of steel in bone.
struct LipMechanics {
  double friction_deg = 30.0;              ///< angle of friction of a chip on the rake face
  double speed_exponent = 0.06;            ///< cutting energy and chisel pressure go with the speed to this
  double reference_rpm = 1250.0;           ///< at which the energies hold
  double margin_pressure_share = 0.005;    ///< wall's pressure on the margins over the energy of cutting it
  double chip_torque_per_diameter = 0.01;  ///< more torque by chips in the flutes, for a diameter of depth
};

/// How forces differ between published sources beyond what the law explains: a measured force over the law's is
/// log-normal with few sources behind it, so its logarithm is Student's t. docs/forces.md.
struct ForceSpread {
  double median = 1.0;     ///< measured over the law's
  double log_scale = 0.0;  ///< of the logarithm; 0: nothing is known of it, the band has no width
  double degrees = 4.0;    ///< of freedom, whole

  bool operator==(const ForceSpread&) const = default;
};

/// How hard bone is to drill, from its CT number: a calibration for its density, and power laws of the density for what
/// the lips and the chisel edge of a bit meet. docs/forces.md derives them; the numbers and their sources are in
/// data/materials/.
struct Material {
  HuToDensity density = {};

  /// Energy of cutting a volume, N·mm/mm³, of bone of 1 g/cm³ at a feed of `reference_feed_mm` per turn.
  double specific_cutting_energy_mpa = 356.0;
  double cutting_exponent = 2.0;    ///< of the density in g/cm³
  double reference_feed_mm = 0.1;   ///< per turn
  double feed_exponent = 0.3;       ///< the energy goes with the feed per turn to minus this: thin chips cost more
  double lip_thrust_share = 0.376;  ///< thrust of the lips over the force along their cut

  /// Pressure of the chisel edge, which indents bone and does not cut, N/mm² of bone of 1 g/cm³.
  double chisel_mpa = 145.0;
  double chisel_exponent = 2.0;
  double chisel_share = 0.16;  ///< width of the chisel edge over the bit's diameter, where the bit states none

  /// Of a bit that touches without cutting: force over depth, N/mm, of bone of 1 g/cm³, of a surface as large as the
  /// bit's section.
  double contact_n_mm = 200.0;
  double contact_exponent = 1.56;

  CuttingLaw law = CuttingLaw::power;
  LipMechanics lips = {};
  /// Of measured forces about those of the numbers above.
  ForceSpread thrust_spread = {0.308, 1.050, 9.0};
  ForceSpread torque_spread = {0.476, 1.001, 6.0};

  /// Of cutting at the reference feed, N·mm/mm³.
  double cutting_energy_mpa(double hu) const;
  /// Under the chisel edge, N/mm².
  double chisel_pressure_mpa(double hu) const;
  /// Of a surface as large as the bit's section, N/mm.
  double contact_stiffness_n_mm(double hu) const;
};

/// The same bone, `factor` times as hard to cut and to indent: what a study draws from the spread between sources.
/// Throws Error on a factor that is not above 0.
Material with_forces_times(const Material& material, double factor);

/// Rejects values that are not finite, and models by which denser bone would be easier to drill.
void check_material(const Material& material);

/// A material's cutting pressure for each CT number of a range, in whole units, so that a sum over points does not
/// depend on its order.
class PressureTable {
 public:
  static constexpr double kUnitMpa = 1e-3;
  static constexpr std::int64_t kMaxUnits = std::int64_t{1} << 24;  ///< 16.8 GPa: no bone resists with more

  explicit PressureTable(const Material& material, std::int16_t lowest_hu = -32768, std::int16_t highest_hu = 32767);

  /// Pressure in units of kUnitMpa. `hu` must be in the range.
  std::int64_t units(std::int16_t hu) const {
    const int index = hu - lowest_hu_;
    return units_[static_cast<std::size_t>(index)];
  }
  /// Of the hardest CT number in the range.
  std::int64_t highest_units() const { return units_.back(); }
  std::size_t memory_bytes() const { return units_.size() * sizeof(units_[0]); }

 private:
  int lowest_hu_;
  std::vector<std::int64_t> units_;
};

}  // namespace spinaltap
