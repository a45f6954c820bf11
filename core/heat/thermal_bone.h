#pragma once

#include <limits>

namespace spinaltap {

/// How a tissue takes up heat and lets it through.
struct ThermalTissue {
  double conductivity_w_mm_k = 0.0;  ///< 0: lets none through
  double capacity_j_mm3_k = 0.0;     ///< of a volume: density times specific heat

  /// How fast heat spreads, mm²/s.
  double diffusivity_mm2_s() const { return conductivity_w_mm_k / capacity_j_mm3_k; }
};

/// Bone by its density: measured at two, between which it is interpolated; beyond them it is as at the nearer one. The
/// numbers and their sources are in data/thermal/bone.json; read_thermal_bone() reads such a file.
struct ThermalBone {
  double cancellous_density_g_cm3 = 0.2;
  double cortical_density_g_cm3 = 1.81;
  ThermalTissue cancellous = {2.929e-4, 3.054e-3};
  ThermalTissue cortical = {5.5e-4, 2.2625e-3};
  double temperature_c = 37.0;    ///< of the bone before it is drilled
  double shear_angle_deg = 45.0;  ///< at which chips part from the bone, to the direction of the cut
  double water_w_mm2_k = 1.0e-3;  ///< heat that irrigation takes off the hole's wall

  /// Bone of a density, g/cm³.
  ThermalTissue at(double density_g_cm3) const;
};

/// Throws Error on values that are not finite, conductivities, capacities and densities that are not above 0, and where
/// cortical bone is not the denser.
void check_thermal_bone(const ThermalBone& bone);

/// The temperature of the bone beside the hole, live (HoleHeat): docs/heat.md.
struct HeatOptions {
  ThermalBone bone = {};
  bool is_irrigated = false;  ///< the hole's wall gives heat off to water
  double distance_mm = 0.5;   ///< from the wall, where the temperature is told
  double limit_c = 47.0;      ///< above it there is an event: heat_limit
};
/// Rejects options that are not numbers or make no sense.
void check_heat_options(const HeatOptions& options);

/// What a cycle's heat came to; temperatures and the depth are no numbers where the session works out none.
struct CycleHeat {
  double bone_w = 0.0;  ///< that the bone gets: cutting_heat()
  /// Of the hottest place beside the hole, up to a second old where the hole is 40 mm deep.
  double temperature_c = std::numeric_limits<double>::quiet_NaN();
  double max_temperature_c = std::numeric_limits<double>::quiet_NaN();  ///< so far
  double max_depth_mm = std::numeric_limits<double>::quiet_NaN();       ///< where: along the path, 0 at the entry
};

}  // namespace spinaltap
