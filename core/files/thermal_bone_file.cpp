#include "core/files/thermal_bone_file.h"

#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/files/data_files.h"
#include "core/files/json_file.h"

namespace spinaltap {
namespace {

constexpr FileFormat kThermalBoneFormat{"spinaltap-thermal-bone", "file of how bone takes up heat", "see docs/heat.md"};
constexpr double kPerMetre = 1e-3;        // W/(m K) to W/(mm K); MJ/(m³ K) to J/(mm³ K)
constexpr double kPerSquareMetre = 1e-6;  // W/(m² K) to W/(mm² K)

}  // namespace

ThermalBone read_thermal_bone(const std::filesystem::path& path) {
  const Json json = read_json(path);
  check_format(json, kThermalBoneFormat, path);
  check_keys(json,
             {"format", "version", "name", "cancellous_density_g_cm3", "cancellous_conductivity_w_m_k",
              "cancellous_capacity_mj_m3_k", "cortical_density_g_cm3", "cortical_conductivity_w_m_k",
              "cortical_capacity_mj_m3_k", "temperature_c", "shear_angle_deg", "water_w_m2_k", "sources", "assumed"},
             path, "a number of how bone takes up heat");
  const JsonObject object(json, path);
  ThermalBone bone;
  bone.cancellous_density_g_cm3 = object.number("cancellous_density_g_cm3");
  bone.cancellous = {kPerMetre * object.number("cancellous_conductivity_w_m_k"),
                     kPerMetre * object.number("cancellous_capacity_mj_m3_k")};
  bone.cortical_density_g_cm3 = object.number("cortical_density_g_cm3");
  bone.cortical = {kPerMetre * object.number("cortical_conductivity_w_m_k"),
                   kPerMetre * object.number("cortical_capacity_mj_m3_k")};
  bone.temperature_c = object.number("temperature_c");
  bone.shear_angle_deg = object.number("shear_angle_deg");
  bone.water_w_mm2_k = kPerSquareMetre * object.number("water_w_m2_k");
  try {
    check_thermal_bone(bone);
  } catch (const Error& error) {
    fail(path.string(), ": ", error.what());
  }
  return bone;
}

ThermalBone shipped_thermal_bone() { return read_thermal_bone(data_file("thermal/bone.json")); }

}  // namespace spinaltap
