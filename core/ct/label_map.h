#pragma once

#include <filesystem>

#include "core/ct/ct_volume.h"

namespace spinaltap {

/// Reads a NIfTI label map (.nii, .nii.gz; RAS, any orientation) and gives the voxels of `ct_geometry` whose centre
/// lies in a voxel with `label`. Throws Error when the file is not NIfTI, has no spatial transform, or the label does
/// not occur in it (the message lists those that do) or not within the CT.
BoneMask read_label_map(const std::filesystem::path& file, int label, const GridGeometry& ct_geometry);

}  // namespace spinaltap
