#include "core/heat/cutting_heat.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/geometry.h"

namespace spinaltap {

double shear_plane_share(double quarter_number) noexcept {
  const double y = quarter_number;
  if (y == 0.0) return 1.0;
  const double root = std::sqrt(y);
  // The terms cancel: the first three of the series at 0, and of the one at infinity.
  if (y < 1e-4) return 1.0 - 8.0 / 3.0 * root * std::numbers::inv_sqrtpi + y;
  if (y > 20.0) return 1.0 / (4.0 * y);
  return std::erf(root) / (4.0 * y) + (1.0 + y) * std::erfc(root) -
         std::exp(-y) * std::numbers::inv_sqrtpi * (0.5 / root + root);
}

CuttingHeat cutting_heat(const ThermalBone& bone, double diameter_mm, const CuttingState& state) noexcept {
  CuttingHeat heat;
  const double turns_per_s = state.rpm / 60.0;
  const double feed_mm = std::max(state.feed_mm_per_turn, 0.0);
  const double power_n_mm_s =
      2.0 * std::numbers::pi * state.torque_n_mm * turns_per_s + state.thrust_n * feed_mm * turns_per_s;
  if (!(power_n_mm_s > 0.0) || !std::isfinite(power_n_mm_s)) return heat;
  const double speed_mm_s = 2.0 * std::numbers::pi * turns_per_s * diameter_mm / 3.0;
  heat.power_w = 1e-3 * power_n_mm_s;
  heat.peclet = speed_mm_s * 0.5 * feed_mm / bone.at(state.density_g_cm3).diffusivity_mm2_s();
  heat.bone_share = shear_plane_share(0.25 * heat.peclet * std::tan(bone.shear_angle_deg * kDegree));
  heat.bone_w = heat.bone_share * heat.power_w;
  return heat;
}

}  // namespace spinaltap
