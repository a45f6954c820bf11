#pragma once

#include "core/drill/corridor.h"
#include "vdb/bone_model.h"

namespace spinaltap {

/// widest_corridor() through a baked bone.
DrillPath suggest_path(const BoneModel& bone, const DrillBit& bit, const Progress& progress = {});

/// Throws Error, which says where both lie, when no point of the path's axis is inside the bone.
void check_path_meets_bone(const DrillPath& path, const BoneModel& bone);

}  // namespace spinaltap
