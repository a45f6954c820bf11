#pragma once

#include <span>

#include "core/session/operator/straight_ways.h"
#include "core/tool/drill_bit.h"
#include "vdb/grid/bone_model.h"

namespace spinaltap {

/// The bone without what a bit took that moved along its own axis from `start` to `end` (patient LPS, mm; same axis):
/// the larger of the bone's distance and minus the swept bit's. The swept bit is the bit at `end`, lengthened backwards
/// by the way. The bone as it was and the hole are kept beside it: see is_drilled(). Throws Error when the axes differ.
BoneModel subtract_bit(const BoneModel& bone, const DrillBit& bit, const Pose& start, const Pose& end);

/// The same for many ways, in one go over the bone.
BoneModel subtract_bit(const BoneModel& bone, const DrillBit& bit, std::span<const BitWay> ways);

/// The bone without what a bit took on its ways through poses (patient LPS, mm), straight from each pose to the next as
/// seen from the bit, in any direction; as cutting_ways() gives them. To a hundredth of a voxel.
BoneModel subtract_motion(const BoneModel& bone, const DrillBit& bit, std::span<const std::vector<Pose>> ways);

}  // namespace spinaltap
