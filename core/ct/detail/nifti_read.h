#pragma once

#include <filesystem>

#include "core/base/progress.h"
#include "core/ct/ct_volume.h"

namespace spinaltap {

/// Reads a CT from a NIfTI file (.nii, .nii.gz) whose values are HU: rounded, clamped to 16 bit; what is not a number
/// becomes air. RAS is turned into LPS here, and the axes change places until i, j and k run as nearly to the left, to
/// the back and to the head as they can, so that a CT converted from axial DICOM gets its slices back. A stack that
/// leans (a tilted gantry's, kept as shear of the third axis) is resampled onto an orthogonal grid (resample_stack()).
/// Throws Error for what NiftiVolume rejects, for one slice alone, and for any other shear.
CtVolume read_nifti_ct(const std::filesystem::path& file, const Progress& progress = {});

}  // namespace spinaltap
