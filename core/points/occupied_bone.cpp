#include "core/points/occupied_bone.h"

namespace spinaltap {

OccupiedBone::Table::Table(const Material& material, std::pair<int, int> hu_range) : lowest_hu_(hu_range.first) {
  check_material(material);
  for (int hu = hu_range.first; hu <= hu_range.second; ++hu) {
    bones_.push_back(
        {material.density.density_g_cm3(hu), material.chisel_pressure_mpa(hu), material.contact_stiffness_n_mm(hu)});
  }
}

}  // namespace spinaltap
