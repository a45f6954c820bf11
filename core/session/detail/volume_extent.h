#pragma once

#include <span>

#include "core/points/point_volume.h"
#include "core/tool/bit_profile.h"

namespace spinaltap {

/// The cylinder that point volumes, end to end along a path, stand for.
class VolumeExtent {
 public:
  explicit VolumeExtent(std::span<const PointVolume> volumes);

  /// Place in the cylinder's own coordinates: z from 0 along it.
  Vec3 to_own(const Vec3& p_mm) const { return frame_.to_path(p_mm); }
  double radius_mm() const { return radius_mm_; }
  double length_mm() const { return length_mm_; }
  /// The coarsest of the volumes': nearer than this to the border nothing is known.
  double spacing_mm() const { return spacing_mm_; }

  /// How far the tip lies past the cylinder's end, mm; negative: how far before.
  double past_end_mm(const Vec3& tip_mm) const { return to_own(tip_mm).z() - length_mm_; }
  /// How far the part of a bit that lies deeper than `from_depth_mm` (as to_own() has it) reaches out of the cylinder's
  /// side, mm; negative: how much room there is.
  double beyond_side_mm(const BitProfile& bit, const Pose& pose, double from_depth_mm) const noexcept;

 private:
  PathFrame frame_;
  double radius_mm_ = 0.0;
  double length_mm_ = 0.0;
  double spacing_mm_ = 0.0;
};

}  // namespace spinaltap
