#pragma once

#include "core/drill/corridor.h"
#include "vdb/bone_model.h"

namespace spinaltap {

/// widest_corridor() through a baked bone.
DrillPath suggest_path(const BoneModel& bone, const DrillBit& bit, const Progress& progress = {});

}  // namespace spinaltap
