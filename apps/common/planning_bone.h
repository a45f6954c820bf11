#pragma once

#include <memory>

#include "core/plan/grade.h"
#include "vdb/bone_model.h"

namespace spinaltap {

/// A baked vertebra with all that suggesting and grading paths ask of it.
class PlanningBone {
 public:
  /// Reads shape and landmarks out of the grids, in about a second. Throws Error where there is not one whole vertebra.
  explicit PlanningBone(BoneModel bone, const Progress& progress = {});

  const BoneModel& bone() const { return bone_; }
  const BoneShape& shape() const { return *shape_; }
  const Landmarks& landmarks() const { return *landmarks_; }
  const WallDistance& walls() const { return *walls_; }
  /// CT numbers of the bone's grid, tri-linear.
  HuSampler hu() const;

 private:
  BoneModel bone_;
  std::unique_ptr<const BoneShape> shape_;
  std::unique_ptr<const Landmarks> landmarks_;
  std::unique_ptr<const WallDistance> walls_;
};

}  // namespace spinaltap
