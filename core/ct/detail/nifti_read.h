#pragma once

#include <filesystem>

#include "core/base/progress.h"
#include "core/ct/ct_volume.h"
#include "core/ct/grid_geometry.h"

namespace spinaltap {

/// Reads a CT from a NIfTI file (.nii, .nii.gz) whose values are HU, as ct_of_volume() has it: RAS is turned into LPS
/// here. The volume's warnings are those of its place (place_nifti()). Throws Error for what NiftiVolume and
/// ct_of_volume() reject.
CtVolume read_nifti_ct(const std::filesystem::path& file, NiftiAffine affine = NiftiAffine::automatic,
                       const Progress& progress = {});

}  // namespace spinaltap
