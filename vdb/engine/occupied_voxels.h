#pragma once

#include <memory>

#include "core/points/material.h"
#include "core/points/occupied_bone.h"
#include "vdb/engine/voxel_bone.h"

namespace spinaltap {

/// Voxels as forces and sessions ask of them. Their own frame is patient LPS. Ahead of a place means tri-linearly among
/// the eight voxels that are one layer or two ahead, none of which lies behind. Only a bone of a region has an end and
/// a side. The voxels must outlive it; one thread asks at a time. Throws Error on a bad material.
std::unique_ptr<OccupiedBone> make_occupied_bone(const VoxelBone& bone, const Material& material);

}  // namespace spinaltap
