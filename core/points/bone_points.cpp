#include "core/points/bone_points.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/error.h"
#include "core/base/text_fields.h"
#include "core/tool/path_curve.h"

namespace spinaltap {

std::ptrdiff_t nearest_point(const DiscPattern& pattern, double x_mm, double y_mm) noexcept {
  const double off_mm = std::sqrt(x_mm * x_mm + y_mm * y_mm);
  double turns = std::atan2(y_mm, x_mm) / (2.0 * std::numbers::pi);
  if (turns < 0.0) turns += 1.0;
  double ring_mm = off_mm;
  if (pattern.subdivision() == DiscSubdivision::hexagons) {
    // A hexagon's side is nearer than its corners, and its points are even along it, not around.
    const double corner = std::min(std::floor(6.0 * turns), 5.0);
    const double from_middle = (turns - (corner + 0.5) / 6.0) * 2.0 * std::numbers::pi;
    ring_mm *= std::cos(from_middle) / (0.5 * std::numbers::sqrt3);
    turns = (corner + 0.5 + 0.5 * std::numbers::sqrt3 * std::tan(from_middle)) / 6.0;
  }
  const double ring_number = std::floor(ring_mm / pattern.spacing_mm() + 0.5);
  if (!(ring_number < pattern.ring_count())) return -1;
  const int ring = static_cast<int>(ring_number);
  const auto size = static_cast<std::ptrdiff_t>(DiscPattern::ring_size(ring));
  const auto place = static_cast<std::ptrdiff_t>(std::lround(turns * static_cast<double>(size)));
  return static_cast<std::ptrdiff_t>(DiscPattern::ring_start(ring)) + (place < size ? place : 0);
}

BonePoints::BonePoints(std::span<const PointVolume> volumes, const Material& material)
    : volumes_(volumes), radius_mm_(std::numeric_limits<double>::infinity()) {
  check_material(material);
  if (volumes.empty()) fail("forces: expected one volume or more, found none");
  std::pair<int, int> range{32767, -32768};
  for (const PointVolume& volume : volumes) {
    const Pose start = frame().to_path(volume.frame().to_patient(Pose{}));
    const Vec3 x_axis = frame().to_path(volume.frame().to_patient(Pose{Vec3::Zero(), Vec3::UnitX()})).axis;
    const bool is_along = std::hypot(start.tip_mm.x(), start.tip_mm.y()) < 1e-6 &&
                          (start.axis - Vec3::UnitZ()).norm() < 1e-9 && (x_axis - Vec3::UnitX()).norm() < 1e-9;
    if (!is_along || (!starts_mm_.empty() && !(start.tip_mm.z() > starts_mm_.back()))) {
      fail("forces: expected volumes end to end along one path, found number ", starts_mm_.size() + 1, " elsewhere");
    }
    // Discs and rings stand for what lies within half a spacing of them.
    const double spacing_mm = volume.pattern().spacing_mm();
    starts_mm_.push_back(start.tip_mm.z());
    widest_spacing_mm_ = std::max(widest_spacing_mm_, spacing_mm);
    radius_mm_ = std::min(radius_mm_, (volume.pattern().ring_count() - 0.5) * spacing_mm);
    length_mm_ = std::max(length_mm_, start.tip_mm.z() + (volume.disc_count() - 0.5) * spacing_mm);
    const auto [lowest, highest] = volume.hu_range();
    range = {std::min<int>(range.first, lowest), std::max<int>(range.second, highest)};
  }
  bones_ = Table(material, range);
}

bool BonePoints::has_occupied() const {
  return std::ranges::any_of(volumes_, [](const PointVolume& volume) {
    return std::ranges::any_of(volume.occupancy_words(), [](std::uint64_t word) { return word != 0; });
  });
}

std::size_t BonePoints::volume_at(double z_mm) const noexcept {
  // Discs stand for the layer around them.
  std::size_t n = volumes_.size() - 1;
  while (n > 0 && z_mm < starts_mm_[n] - 0.5 * volumes_[n].pattern().spacing_mm()) --n;
  return n;
}

const OccupiedBone::Bone* BonePoints::occupied_at(const Vec3& p) const noexcept {
  const std::size_t n = volume_at(p.z());
  const PointVolume& volume = volumes_[n];
  const double disc = std::floor((p.z() - starts_mm_[n]) / volume.pattern().spacing_mm() + 0.5);
  if (!(disc >= 0.0 && disc < volume.disc_count())) return nullptr;
  const std::ptrdiff_t index = nearest_point(volume.pattern(), p.x(), p.y());
  const int number = static_cast<int>(disc);
  if (index < 0 || !volume.is_occupied(number, static_cast<std::size_t>(index))) return nullptr;
  return &bones_.of(volume.hu(number, static_cast<std::size_t>(index)));
}

void BonePoints::add_ahead_of(const Vec3& p, const Vec3& axis, double share, Mean& mean) const noexcept {
  // Axes nearer to the discs' planes than this (cosine) look one spacing ahead; no disc is ahead of them.
  constexpr double kSteepest = 0.25;
  const double along = axis.z();
  const std::size_t volume = volume_at(p.z());
  const double spacing_mm = volumes_[volume].pattern().spacing_mm();
  if (!(std::abs(along) >= kSteepest)) return mean.add(occupied_at(p + spacing_mm * axis), share);
  // In discs towards which the bit points. The disc at the tip itself is cut; rounding does not make it the next.
  const double sign = along > 0.0 ? 1.0 : -1.0;
  const double at = sign * (p.z() - starts_mm_[volume]) / spacing_mm;
  const double next = std::floor(at + 1e-6) + 1.0;
  const double nearer = std::clamp(next - at, 0.0, 1.0);
  const auto on_disc = [&](double disc) -> Vec3 { return p + (disc - at) * spacing_mm / std::abs(along) * axis; };
  mean.add(occupied_at(on_disc(next)), share * nearer);
  mean.add(occupied_at(on_disc(next + 1.0)), share * (1.0 - nearer));
}

void BonePoints::check_within(const DrillPath& path) const {
  constexpr double kPlacesMm = 0.25;
  for (const Vec3& end_mm : PathCurve(path).places_mm(kPlacesMm)) {
    const Vec3 own = frame().to_path(end_mm);
    const double aside_mm = std::hypot(own.x(), own.y());
    if (!(aside_mm <= radius_mm_) || !(own.z() <= length_mm_ + widest_spacing_mm_)) {
      fail("path ", in_quotes(path.name), ": expected it within the point volume, a cylinder of ", length_mm_,
           " mm and a radius of ", radius_mm_, " mm, found a place ", aside_mm, " mm off its axis at ", own.z(),
           " mm along it");
    }
  }
}

double BonePoints::past_end_mm(const Vec3& tip_mm) const noexcept { return frame().to_path(tip_mm).z() - length_mm_; }

double BonePoints::beyond_side_mm(const BitProfile& bit, const Pose& pose, const Vec3& contact_mm) const noexcept {
  const Pose own = frame().to_path(pose);
  const double from_depth_mm = frame().to_path(contact_mm).z();
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
      consider(std::clamp(piece.ball_centre_mm, piece.begin_mm, piece.end_mm), piece.widest_mm());
    }
  }
  for (const double depth_mm : {from_depth_mm, length_mm_}) {
    const double back_mm = (own.tip_mm.z() - depth_mm) / own.axis.z();
    const double radius_mm = std::isfinite(back_mm) ? bit.widest_mm(back_mm, back_mm) : -1.0;
    if (radius_mm >= 0.0) consider(back_mm, radius_mm);  // a short bit may have ended before
  }
  return max_mm;
}

}  // namespace spinaltap
