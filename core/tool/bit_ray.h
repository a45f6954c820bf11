#pragma once

#include <vector>

#include "core/tool/tool_body.h"

namespace spinaltap {

/// A stretch of a ray, mm from its start, which may lie behind it.
struct RayStretch {
  double begin_mm = 0.0;
  double end_mm = 0.0;
};

/// A bit at a place, and what rays meet of it: exact, since its outline is of pieces with radius² quadratic in the way
/// back from the tip, and so is a ray's distance off the axis; a plate is a box.
class BitBody {
 public:
  /// Pose: patient LPS, mm; of a plate a sound one, see valid_pose().
  BitBody(const ToolBody& body, const Pose& pose) : body_(body), pose_(pose) {}
  /// Throws Error on a bad bit, and on a pose that is not sound of a plate.
  BitBody(const DrillBit& bit, const Pose& pose);

  const Pose& pose() const { return pose_; }

  /// Appends where a ray (unit direction) runs within the bit, a stretch for each piece of it that it meets.
  void append_stretches(const Vec3& start_mm, const Vec3& direction, std::vector<RayStretch>& stretches) const;
  /// Signed distance, mm, negative within.
  double distance_mm(const Vec3& p_mm) const;
  /// Unit, outward, at a place of its surface.
  Vec3 normal(const Vec3& p_mm) const;

 private:
  void append_stretches_of(const BitProfile& profile, const Vec3& start_mm, const Vec3& direction,
                           std::vector<RayStretch>& stretches) const;
  void append_stretches_of(const PlateBox& plate, const Vec3& start_mm, const Vec3& direction,
                           std::vector<RayStretch>& stretches) const;

  ToolBody body_;
  Pose pose_;
};

/// Sorts stretches, and joins those that overlap or touch.
void join_stretches(std::vector<RayStretch>& stretches);

}  // namespace spinaltap
