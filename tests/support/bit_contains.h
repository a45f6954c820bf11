#pragma once

#include "core/tool/bit_profile.h"

namespace spinaltap::test {

/// Whether the bit at `pose` holds point p (same frame as the pose, mm).
inline bool bit_contains(const BitProfile& bit, const Pose& pose, const Vec3& p) {
  const Vec3 from_tip_mm = p - pose.tip_mm;
  const double back_mm = -from_tip_mm.dot(pose.axis);
  return bit.contains(back_mm, (from_tip_mm + back_mm * pose.axis).squaredNorm());
}

}  // namespace spinaltap::test
