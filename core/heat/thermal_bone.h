#pragma once

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

  ThermalTissue at(double density_g_cm3) const;
};

/// Throws Error on values that are not finite, conductivities, capacities and densities that are not above 0, and where
/// cortical bone is not the denser.
void check_thermal_bone(const ThermalBone& bone);

}  // namespace spinaltap
