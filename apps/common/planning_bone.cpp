#include "apps/common/planning_bone.h"

#include "core/base/error.h"
#include "vdb/bone_field.h"

namespace spinaltap {

PlanningBone::PlanningBone(BoneModel bone, const Progress& progress) : bone_(std::move(bone)) {
  if (bone_.bounds_mm().isEmpty()) fail("planning: the bone is empty");
  // Up to a voxel from the surface the grid's own values are better than what is worked out from points.
  shape_ = std::make_unique<const BoneShape>(std::make_shared<const BoneField>(bone_), bone_.bounds_mm(),
                                             bone_.voxel_mm(), progress);
  landmarks_ = std::make_unique<const Landmarks>(find_landmarks(*shape_, progress));
  walls_ = std::make_unique<const WallDistance>(*shape_, *landmarks_);
}

HuSampler PlanningBone::hu() const {
  return [bone = bone_](std::span<const Vec3> points_mm, std::span<float> hu) { bone.hu(points_mm, hu, {}); };
}

}  // namespace spinaltap
