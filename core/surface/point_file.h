#pragma once

#include <filesystem>

#include "core/surface/surface_samples.h"

namespace spinaltap {

/// Writes points as binary PLY: x, y, z (mm, patient LPS), nx, ny, nz, value (mm), one float each; the surface points
/// (value 0) come first. `path` must be a staged (temporary) name. Throws Error when the disk is full.
void write_points(const SurfaceSamples& samples, const std::filesystem::path& path);

}  // namespace spinaltap
