#pragma once

#include "core/plan/bone_shape.h"
#include "core/plan/landmarks.h"

namespace spinaltap {

/// How far a place is from the vertebra's outer surface and from the canal: positive in the bone, negative by how far
/// it is beyond that surface. Beyond the one, the other is still positive.
class WallDistance {
 public:
  /// `bone` must outlive this; `landmarks` must be its own.
  WallDistance(const BoneShape& bone, const Landmarks& landmarks);

  struct Wall {
    double distance_mm = 0.0;        ///< signed
    Vec3 nearest_mm = Vec3::Zero();  ///< the place of the wall that is nearest, patient LPS
  };
  Wall outer(const Vec3& p_mm) const;
  Wall canal(const Vec3& p_mm) const;

  const BoneShape& bone() const { return bone_; }
  const Landmarks& landmarks() const { return landmarks_; }

 private:
  const BoneShape& bone_;
  const Landmarks& landmarks_;
};

}  // namespace spinaltap
