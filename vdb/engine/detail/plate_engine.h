#pragma once

#include <memory>

#include "core/engine/drill_engine.h"
#include "vdb/engine/voxel_bone.h"

namespace spinaltap::detail {

/// Mills voxels with a plate: the voxel engine of saws and osteotomes. Throws Error on a bad plate or material.
std::unique_ptr<DrillEngine> make_plate_engine(VoxelBone& bone, const DrillBit& plate, const Material& material);

}  // namespace spinaltap::detail
