#include "core/session/detail/volume_extent.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/error.h"

namespace spinaltap {

VolumeExtent::VolumeExtent(std::span<const PointVolume> volumes) : radius_mm_(std::numeric_limits<double>::infinity()) {
  if (volumes.empty()) fail("drilling: expected a point volume at least, found none");
  frame_ = volumes.front().frame();
  for (const PointVolume& volume : volumes) {
    // Discs and rings stand for what lies within half a spacing of them.
    const double spacing_mm = volume.pattern().spacing_mm();
    const double begin_mm = to_own(volume.frame().to_patient(Vec3::Zero())).z();
    radius_mm_ = std::min(radius_mm_, (volume.pattern().ring_count() - 0.5) * spacing_mm);
    length_mm_ = std::max(length_mm_, begin_mm + (volume.disc_count() - 0.5) * spacing_mm);
    spacing_mm_ = std::max(spacing_mm_, spacing_mm);
  }
}

double VolumeExtent::beyond_side_mm(const BitProfile& bit, const Pose& pose, double from_depth_mm) const noexcept {
  const Pose own = frame_.to_path(pose);
  double max_mm = -std::numeric_limits<double>::infinity();
  const auto consider = [&](double back_mm, double radius_mm) {
    const Vec3 middle = own.tip_mm - back_mm * own.axis;
    if (!(middle.z() >= from_depth_mm - 1e-9 && middle.z() <= length_mm_)) return;
    max_mm = std::max(max_mm, std::hypot(middle.x(), middle.y()) + radius_mm - radius_mm_);
  };
  // The way of the axis off the cylinder's is convex along it: ends of the outline's pieces decide, and where the part
  // ends.
  for (const ProfilePiece& piece : bit.pieces()) {
    consider(piece.begin_mm, piece.begin_radius_mm);
    consider(piece.end_mm, piece.end_radius_mm);
    if (piece.ball_radius_mm > 0.0) {
      consider(std::clamp(piece.ball_centre_mm, piece.begin_mm, piece.end_mm), piece.ball_radius_mm);
    }
  }
  for (const double depth_mm : {from_depth_mm, length_mm_}) {
    const double back_mm = (own.tip_mm.z() - depth_mm) / own.axis.z();
    if (std::isfinite(back_mm)) consider(back_mm, bit.widest_mm(back_mm, back_mm));
  }
  return max_mm;
}

}  // namespace spinaltap
