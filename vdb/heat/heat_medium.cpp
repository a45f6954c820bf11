#include "vdb/heat/heat_medium.h"

#include <utility>
#include <vector>

namespace spinaltap {

BoneMedium::BoneMedium(BoneModel bone, const HuToDensity& density, const ThermalBone& thermal)
    : bone_(std::move(bone)), density_(density), thermal_(thermal) {
  check_thermal_bone(thermal_);
}

void BoneMedium::tissues(std::span<const Vec3> points_mm, std::span<ThermalTissue> tissues) const {
  std::vector<float> density_g_cm3(points_mm.size());
  std::vector<std::uint8_t> inside(points_mm.size());
  bone_density(bone_, density_, points_mm, density_g_cm3);
  bone_.inside(points_mm, inside);
  for (std::size_t n = 0; n < points_mm.size(); ++n) {
    tissues[n] = inside[n] != 0 ? thermal_.at(static_cast<double>(density_g_cm3[n])) : ThermalTissue{};
  }
}

}  // namespace spinaltap
