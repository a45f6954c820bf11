#pragma once

#include "core/tool/drill_path.h"
#include "vdb/grid/bone_model.h"

namespace spinaltap {

/// Throws Error, which says where both lie, when no point of the path's axis is inside the bone.
void check_path_meets_bone(const DrillPath& path, const BoneModel& bone);

}  // namespace spinaltap
