#pragma once

#include "core/ct/ct_volume.h"
#include "vdb/grid/bone_model.h"

namespace spinaltap {

/// The CT that a baked bone keeps, resampled (tri-linear) around its surface for slices: -1024 HU where it keeps none.
CtVolume ct_of_bone(const BoneModel& bone, double voxel_mm = 0.4);

}  // namespace spinaltap
