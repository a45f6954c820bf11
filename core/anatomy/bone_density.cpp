#include "core/anatomy/bone_density.h"

#include <cmath>
#include <utility>
#include <vector>

#include "core/anatomy/inside_bone.h"

namespace spinaltap {

DensitySampler bone_density(const BoneShape& bone, HuSampler hu, const HuToDensity& calibration) {
  return [&bone, hu = std::move(hu), calibration](std::span<const Vec3> places_mm, std::span<double> g_cm3) {
    const std::vector<float> values_hu = hu_inside_bone(bone, hu, places_mm);
    for (std::size_t n = 0; n < places_mm.size(); ++n) {
      const auto value_hu = static_cast<double>(values_hu[n]);
      g_cm3[n] = std::isfinite(value_hu) ? calibration.density_g_cm3(value_hu) : 0.0;
    }
  };
}

}  // namespace spinaltap
