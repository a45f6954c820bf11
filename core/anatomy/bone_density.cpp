#include "core/anatomy/bone_density.h"

#include <cmath>
#include <utility>
#include <vector>

#include "core/anatomy/inside_bone.h"

namespace spinaltap {

DensitySampler bone_density(const BoneShape& bone, HuSampler hu, const HuToDensity& calibration) {
  return [&bone, hu = std::move(hu), calibration](std::span<const Vec3> places_mm, std::span<double> g_cm3) {
    const std::vector<std::uint8_t> inside = inside_bone(bone, places_mm);
    std::vector<Vec3> in_bone_mm;
    for (std::size_t n = 0; n < places_mm.size(); ++n) {
      if (inside[n] != 0) in_bone_mm.push_back(places_mm[n]);
    }
    std::vector<float> found_hu(in_bone_mm.size());
    if (!in_bone_mm.empty()) hu(in_bone_mm, found_hu);
    std::size_t next = 0;
    for (std::size_t n = 0; n < places_mm.size(); ++n) {
      const double value_hu = inside[n] != 0 ? static_cast<double>(found_hu[next++]) : std::nan("");
      g_cm3[n] = std::isfinite(value_hu) ? calibration.density_g_cm3(value_hu) : 0.0;
    }
  };
}

}  // namespace spinaltap
