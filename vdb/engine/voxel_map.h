#pragma once

#include "core/ct/label_volume.h"
#include "vdb/engine/voxel_bone.h"

namespace spinaltap {

/// The occupied voxels as they now are, as a label map: 1 is "occupied bone". Its grid is the voxels' own, the box of
/// those that live, in patient LPS. encode_label_volume() writes it for 3D Slicer and ParaView. Throws Error where
/// nothing lives, and on a box of over 2^31 voxels, a byte each.
LabelVolume voxel_map(const VoxelBone& bone);

}  // namespace spinaltap
