#pragma once

#include "core/files/json_file.h"
#include "core/points/material.h"

namespace spinaltap {

Json to_json(const ForceSpread& spread);
/// Throws Error that names the file and the key at fault; does not check the numbers.
ForceSpread read_force_spread(const Json& json, const std::filesystem::path& file);

/// All of a material, the density calibration with it: as records hold it.
Json to_json(const Material& material);
/// Reads what to_json() made. Throws Error that names the file and the key at fault; does not check the model.
Material material_of(const Json& json, const std::filesystem::path& file);

}  // namespace spinaltap
