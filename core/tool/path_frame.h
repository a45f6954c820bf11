#pragma once

#include "core/base/geometry.h"
#include "core/tool/drill_bit.h"

namespace spinaltap {

/// Path-local coordinates: the origin where the point volume starts, z along the path, mm. Small numbers near the path
/// keep their precision wherever the patient lies (the paper's section 9.4.4).
class PathFrame {
 public:
  PathFrame() = default;
  /// `origin_mm` in patient LPS; `direction` need not be a unit vector but must not be zero.
  PathFrame(const Vec3& origin_mm, const Vec3& direction);

  Vec3 to_path(const Vec3& p_patient) const { return rotation_.transpose() * (p_patient - origin_mm_); }
  Vec3 to_patient(const Vec3& p_path) const { return origin_mm_ + rotation_ * p_path; }
  Pose to_path(const Pose& pose) const { return {to_path(pose.tip_mm), rotation_.transpose() * pose.axis}; }
  Pose to_patient(const Pose& pose) const { return {to_patient(pose.tip_mm), rotation_ * pose.axis}; }

 private:
  Vec3 origin_mm_ = Vec3::Zero();
  Mat3 rotation_ = Mat3::Identity();  ///< columns: the path's x, y and z axes in patient LPS
};

}  // namespace spinaltap
