#pragma once

#include <filesystem>

#include "core/files/json_file.h"
#include "core/drill/material.h"

namespace spinaltap {

/// Reads a law of data/materials/, which takes the density of another file; see read_density_law(). Throws Error that
/// names the file and the key at fault.
Material read_material(const std::filesystem::path& path, const DensityLaw& density);

/// All of a law, the density's with it: as records hold it.
Json to_json(const Material& material);
/// Reads what to_json() made. Throws Error that names the file and the key at fault; does not check the law.
Material material_of(const Json& json, const std::filesystem::path& file);

}  // namespace spinaltap
