#include "apps/spinaltap/heat_options.h"

#include "core/files/thermal_bone_file.h"

namespace spinaltap {

void HeatChoice::add_to(CLI::App& app) {
  app.add_flag("--irrigation", is_irrigated, "Water, as warm as the bone at first, flows along the hole's wall");
  app.add_option("--thermal-bone", thermal_bone, "How bone takes up heat; default: the shipped thermal/bone.json")
      ->type_name("FILE");
}

HeatOptions HeatChoice::options() const {
  HeatOptions heat;
  heat.bone = thermal_bone.empty() ? shipped_thermal_bone() : read_thermal_bone(thermal_bone);
  heat.is_irrigated = is_irrigated;
  return heat;
}

}  // namespace spinaltap
