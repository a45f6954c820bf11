#pragma once

#include "core/base/progress.h"
#include "core/plan/grade.h"
#include "core/plan/landmarks.h"
#include "core/plan/wall_distance.h"
#include "vdb/grid/bone_model.h"

namespace spinaltap {

/// A baked bone with what planning asks of it, made once: shape, landmarks, walls.
class PlanningBone {
 public:
  /// Throws Error as find_landmarks() does.
  explicit PlanningBone(BoneModel model, const Progress& progress = {});
  PlanningBone(const PlanningBone&) = delete;
  PlanningBone& operator=(const PlanningBone&) = delete;

  const BoneModel& model() const { return model_; }
  const BoneShape& shape() const { return shape_; }
  const Landmarks& landmarks() const { return landmarks_; }
  const WallDistance& walls() const { return walls_; }
  /// Of the baked CT numbers; valid as long as this.
  HuSampler hu() const;

 private:
  BoneModel model_;
  BoneShape shape_;
  Landmarks landmarks_;
  WallDistance walls_;
};

}  // namespace spinaltap
