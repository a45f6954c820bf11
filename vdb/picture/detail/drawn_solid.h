#pragma once

#include <limits>

#include "core/tool/bit_ray.h"

namespace spinaltap::detail {

/// A tool in a picture: what a ray meets of it.
class DrawnSolid {
 public:
  static constexpr double kMissed = std::numeric_limits<double>::infinity();

  /// Throws Error as BitBody does.
  DrawnSolid(const DrillBit& bit, const Pose& pose, const Eigen::Array3d& colour);

  /// How far along a ray (patient LPS, mm; unit direction) its surface lies, from outside; kMissed: nowhere, and where
  /// the ray starts within it.
  double way_mm(const Vec3& start_mm, const Vec3& direction) const;
  /// Unit, outward, at a place of its surface.
  Vec3 normal(const Vec3& p_mm) const { return body_.normal(p_mm); }
  const Eigen::Array3d& colour() const { return colour_; }

 private:
  BitBody body_;
  Eigen::Array3d colour_;
};

}  // namespace spinaltap::detail
