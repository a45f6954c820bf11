#pragma once

#include <filesystem>

#include "core/heat/thermal_bone.h"

namespace spinaltap {

/// Reads how bone takes up heat, as data/thermal/bone.json has it: conductivities in W/(m K), heat capacities in
/// MJ/(m³ K), heat transfer in W/(m² K). Throws Error that names the file and the key at fault.
ThermalBone read_thermal_bone(const std::filesystem::path& path);

/// The one that ships.
ThermalBone shipped_thermal_bone();

}  // namespace spinaltap
