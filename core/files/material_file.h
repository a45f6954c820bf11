#pragma once

#include <filesystem>

#include "core/points/material.h"

namespace spinaltap {

/// Reads a law of data/materials/, which takes the density of another file; see read_density_law(). Throws Error that
/// names the file and the key at fault.
Material read_material(const std::filesystem::path& path, const DensityLaw& density);

}  // namespace spinaltap
