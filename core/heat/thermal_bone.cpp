#include "core/heat/thermal_bone.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"

namespace spinaltap {

ThermalTissue ThermalBone::at(double density_g_cm3) const {
  const double range = cortical_density_g_cm3 - cancellous_density_g_cm3;
  const double share = std::clamp((density_g_cm3 - cancellous_density_g_cm3) / range, 0.0, 1.0);
  return {cancellous.conductivity_w_mm_k + share * (cortical.conductivity_w_mm_k - cancellous.conductivity_w_mm_k),
          cancellous.capacity_j_mm3_k + share * (cortical.capacity_j_mm3_k - cancellous.capacity_j_mm3_k)};
}

void check_thermal_bone(const ThermalBone& bone) {
  const auto check_positive = [](double value, const char* what) {
    if (!(value > 0.0) || !std::isfinite(value)) fail("thermal bone: expected ", what, " above 0, found ", value);
  };
  check_positive(bone.cancellous_density_g_cm3, "a density of cancellous bone");
  check_positive(bone.cancellous.conductivity_w_mm_k, "a conductivity of cancellous bone");
  check_positive(bone.cancellous.capacity_j_mm3_k, "a heat capacity of cancellous bone");
  check_positive(bone.cortical.conductivity_w_mm_k, "a conductivity of cortical bone");
  check_positive(bone.cortical.capacity_j_mm3_k, "a heat capacity of cortical bone");
  if (!(bone.cortical_density_g_cm3 > bone.cancellous_density_g_cm3) || !std::isfinite(bone.cortical_density_g_cm3)) {
    fail("thermal bone: expected cortical bone denser than cancellous bone's ", bone.cancellous_density_g_cm3,
         " g/cm3, found ", bone.cortical_density_g_cm3);
  }
  if (!std::isfinite(bone.temperature_c)) fail("thermal bone: expected a temperature, found ", bone.temperature_c);
  if (!(bone.shear_angle_deg > 0.0) || !(bone.shear_angle_deg < 90.0)) {
    fail("thermal bone: expected a shear angle between 0 and 90 degrees, found ", bone.shear_angle_deg);
  }
  if (!(bone.water_w_mm2_k >= 0.0) || !std::isfinite(bone.water_w_mm2_k)) {
    fail("thermal bone: expected a heat transfer to water of 0 or more, found ", bone.water_w_mm2_k);
  }
}

}  // namespace spinaltap
