#pragma once

#include <vector>

#include "core/tool/bit_profile.h"

namespace spinaltap {

/// A stretch of a ray, mm from its start, which may lie behind it.
struct RayStretch {
  double begin_mm = 0.0;
  double end_mm = 0.0;
};

/// A bit at a place, and what rays meet of it: exact, since its outline is of pieces with radius² quadratic in the way
/// back from the tip, and so is a ray's distance off the axis.
class BitBody {
 public:
  /// Pose: patient LPS, mm.
  BitBody(const BitProfile& profile, const Pose& pose) : profile_(profile), pose_(pose) {}

  const BitProfile& profile() const { return profile_; }
  const Pose& pose() const { return pose_; }

  /// Appends where a ray (unit direction) runs within the bit, a stretch for each piece of it that it meets.
  void append_stretches(const Vec3& start_mm, const Vec3& direction, std::vector<RayStretch>& stretches) const;
  /// Signed distance, mm, negative within.
  double distance_mm(const Vec3& p_mm) const { return bit_distance_mm(profile_, pose_, p_mm); }
  /// Unit, outward, at a place of its surface.
  Vec3 normal(const Vec3& p_mm) const;

 private:
  BitProfile profile_;
  Pose pose_;
};

/// Sorts stretches, and joins those that overlap or touch.
void join_stretches(std::vector<RayStretch>& stretches);

}  // namespace spinaltap
