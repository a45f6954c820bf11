#pragma once

#include <filesystem>

#include "core/ct/hu_to_density.h"
#include "core/points/material.h"

namespace spinaltap {

/// Keys of a density calibration, here and in files of materials.
constexpr const char* kAtZero = "density_at_0_hu_g_cm3";
constexpr const char* kPerHu = "density_per_hu_g_cm3";

/// Reads a density calibration of data/densities/: a JSON object with either "density_at_0_hu_g_cm3" and
/// "density_per_hu_g_cm3", or "calibration": pairs [HU, g/cm³] measured on a calibration phantom, through which a line
/// is laid. Without a calibration the residuals are 0. Throws Error that names the file and the key at fault.
DensityCalibration read_density_calibration(const std::filesystem::path& path);

/// Reads a cutting model of data/materials/, which takes the density of another file; see read_density_calibration().
/// Without "law" it is the power law, without a spread its band has no width.
/// Throws Error that names the file and the key at fault.
Material read_material(const std::filesystem::path& path, const HuToDensity& density);

}  // namespace spinaltap
