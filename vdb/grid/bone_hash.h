#pragma once

#include <string>

#include "vdb/grid/bone_model.h"

namespace spinaltap {

/// A fingerprint of a bone's two grids, 16 hexadecimal digits: of their voxel sizes and places, backgrounds, and every
/// active voxel's place and value. It does not depend on how the file was written, on metadata, or on whether even
/// regions are kept as tiles or as voxels.
std::string bone_hash(const BoneModel& bone);

}  // namespace spinaltap
