#include "vdb/grid/bone_density.h"

namespace spinaltap {

void bone_density(const BoneModel& bone, const DensityLaw& law, std::span<const Vec3> points_mm,
                  std::span<float> density_g_cm3) {
  bone.hu(points_mm, density_g_cm3, {});
  for (float& value : density_g_cm3) value = static_cast<float>(law.density_g_cm3(static_cast<double>(value)));
}

}  // namespace spinaltap
