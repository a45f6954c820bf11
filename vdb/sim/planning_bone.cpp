#include "vdb/sim/planning_bone.h"

#include <memory>

#include "vdb/grid/bone_field.h"

namespace spinaltap {

// Tri-quadratic values are the distance up to one voxel from the surface; see BoneModel::distance().
PlanningBone::PlanningBone(BoneModel model, const Progress& progress)
    : model_(std::move(model)),
      shape_(std::make_shared<BoneField>(model_), model_.bounds_mm(), model_.voxel_mm(), progress),
      landmarks_(find_landmarks(shape_, progress)),
      walls_(shape_, landmarks_) {}

HuSampler PlanningBone::hu() const {
  return [this](std::span<const Vec3> points_mm, std::span<float> hu) { model_.hu(points_mm, hu, {}); };
}

}  // namespace spinaltap
