#pragma once

#include "core/grading/path_check.h"
#include "core/tool/drill_path.h"
#include "vdb/grid/bone_model.h"
#include "vdb/sim/bone.h"

namespace spinaltap {

/// Throws Error, which says where both lie, when no point of the path's axis is inside the bone.
void check_path_meets_bone(const DrillPath& path, const BoneModel& bone);

/// Whether a path fits a baked bone, and where it does not, whether it fits the vertebra above or below it in its file.
PathCheck check_path_on_bone(const Bone& bone, const DrillPath& path, const PathCheckOptions& options = {});

}  // namespace spinaltap
