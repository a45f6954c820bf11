#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/ct/ct_volume.h"
#include "core/ct/grid_geometry.h"

namespace spinaltap {

/// Reads a label map in any of the formats of read_label_volume(), on any grid, and gives the voxels of `ct_geometry`
/// whose centre lies in a voxel with `label`. Throws Error when the file is none of them, does not say where its voxels
/// lie, holds fractions, or the label does not occur in it (the message lists those that do) or not within the CT.
/// `affine`: of a NIfTI file whose two transforms differ. `warnings`: gets what speaks against the place of the file's
/// voxels.
BoneMask read_label_map(const std::filesystem::path& file, int label, const GridGeometry& ct_geometry,
                        NiftiAffine affine = NiftiAffine::automatic, std::vector<std::string>* warnings = nullptr);

/// A mask as a label map's bytes: `label` in the mask, 0 elsewhere, on the mask's grid. The format follows the name's
/// ending, as encode_label_volume() has it. The same mask gives the same bytes. Throws Error on another ending and on
/// labels that are not 1 to 32767.
std::string encode_label_map(const BoneMask& mask, int label, const std::filesystem::path& name);

}  // namespace spinaltap
