#include "core/tool/swept_bit.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace spinaltap {
namespace {

/// Rounding and a straight way's skin, with room: bounds this far out never contradict the exact test.
constexpr double kSpareMm = 1e-5;

/// The smallest rotation that takes unit vector a to b (Rodrigues). Opposite vectors have none: any half turn then.
Mat3 smallest_rotation(const Vec3& a, const Vec3& b) {
  const Vec3 k = a.cross(b);
  const double cosine = a.dot(b);
  if (cosine < -1.0 + 1e-12) {
    const Vec3 side = any_perpendicular(a);
    return 2.0 * side * side.transpose() - Mat3::Identity();
  }
  Mat3 cross;
  cross << 0.0, -k.z(), k.y(), k.z(), 0.0, -k.x(), -k.y(), k.x(), 0.0;
  return Mat3::Identity() + cross + cross * cross / (1.0 + cosine);
}

}  // namespace

SweepProfile::SweepProfile(const BitProfile& profile)
    : bit(profile), straight(profile.grown(kStraightSkinMm)), turning(profile.grown(kTurningSkinMm)) {}

SweptBit::SweptBit(const SweepProfile& outlines, const Pose& from, const Pose& to, Way way_taken) noexcept
    : profile_(&outlines.bit),
      grown_(way_taken == Way::turning ? &outlines.turning : &outlines.straight),
      from_(from),
      to_(to),
      edge_mm_(way_taken == Way::turning ? SweepProfile::kEdge * SweepProfile::kTurningSkinMm : 0.0) {
  const BitProfile& profile = *profile_;
  const Vec3 side = any_perpendicular(from.axis);
  from_rows_.row(0) = side;
  from_rows_.row(1) = from.axis.cross(side);
  from_rows_.row(2) = -from.axis;
  to_rows_ = from_rows_ * smallest_rotation(to.axis, from.axis);
  // How the tip's own way looks from the bit; turning adds at most its angle times the distance from the tip.
  const Vec3 way = to_rows_ * (from.tip_mm - to.tip_mm);
  const double angle = 2.0 * std::asin(std::min(1.0, 0.5 * (to.axis - from.axis).norm()));
  const double way_mm = way.norm();
  const double turned_mm = angle * (profile.length_mm() + profile.radius_mm() + way_mm);
  across_mm_ = std::hypot(way.x(), way.y()) + turned_mm + edge_mm_;
  // A bit that advances had its points nearer to the tip before: further back, seen from the end, there were none.
  forth_mm_ = std::max(0.0, way.z()) + turned_mm + edge_mm_;
  back_mm_ = std::max(0.0, -way.z()) + turned_mm + edge_mm_;
  min_back_mm_ = -back_mm_ - kSpareMm;
  max_back_mm_ = profile.length_mm() + forth_mm_ + kSpareMm;
  const double max_off_axis_mm = profile.radius_mm() + across_mm_ + kSpareMm;
  max_off_axis_squared_mm2_ = max_off_axis_mm * max_off_axis_mm;
  cone_mm_ = profile.cone_offset_mm() + profile.cone_slope() * (back_mm_ + kSpareMm) + across_mm_ + kSpareMm;
  lowest_z_mm_ = std::min(from.tip_mm.z(), to.tip_mm.z());
  highest_z_mm_ = std::max(from.tip_mm.z(), to.tip_mm.z());
  for (const Pose& pose : {from, to}) {
    const double along = pose.axis.z();
    const double sine = std::sqrt(std::max(0.0, 1.0 - along * along));
    for (const ProfilePiece& piece : profile.pieces()) {
      const bool is_ball = piece.ball_radius_mm > 0.0;
      for (const auto& [back_mm, rim_mm] :
           {std::pair(piece.begin_mm, piece.begin_radius_mm), std::pair(piece.end_mm, piece.end_radius_mm)}) {
        const double reach_mm = (is_ball ? piece.widest_mm() : rim_mm) * sine;
        lowest_z_mm_ = std::min(lowest_z_mm_, pose.tip_mm.z() - back_mm * along - reach_mm);
        highest_z_mm_ = std::max(highest_z_mm_, pose.tip_mm.z() - back_mm * along + reach_mm);
      }
    }
  }
  lowest_z_mm_ -= kSpareMm + edge_mm_;
  highest_z_mm_ += kSpareMm + edge_mm_;
}

bool SweptBit::contains(const Vec3& p) const noexcept { return contains_inlined(p); }

bool SweptBit::chord_meets(const Vec3& begin, const Vec3& end) const noexcept {
  const Vec3 way = end - begin;
  for (const ProfilePiece& piece : grown_->pieces()) {
    double first = 0.0;
    double last = 1.0;
    if (way.z() == 0.0) {
      if (!(begin.z() >= piece.begin_mm && begin.z() <= piece.end_mm)) continue;
    } else {
      const double a = (piece.begin_mm - begin.z()) / way.z();
      const double b = (piece.end_mm - begin.z()) / way.z();
      first = std::max(0.0, std::min(a, b));
      last = std::min(1.0, std::max(a, b));
      if (!(first <= last)) continue;
    }
    // excess(t) = off-axis² - radius², a quadratic: c + t (b + t a).
    const auto& s = piece.square;
    const double a = way.x() * way.x() + way.y() * way.y() - s[2] * way.z() * way.z();
    const double b =
        2.0 * (begin.x() * way.x() + begin.y() * way.y()) - s[1] * way.z() - 2.0 * s[2] * begin.z() * way.z();
    const double c = begin.x() * begin.x() + begin.y() * begin.y() - piece.radius_squared_mm2(begin.z());
    const auto excess = [&](double t) { return c + t * (b + t * a); };
    if (excess(first) <= 0.0 || excess(last) <= 0.0) return true;
    if (!(a > 0.0)) continue;
    const double lowest = -b / (2.0 * a);
    if (lowest > first && lowest < last && excess(lowest) <= 0.0) return true;
  }
  return false;
}

BitMotion::BitMotion(const SweepProfile& profile, const Pose& from, const Pose& to) noexcept
    : profile_(&profile), from_(from), to_(to) {
  const Vec3 across = to.axis - to.axis.dot(from.axis) * from.axis;
  const double sine = across.norm();
  angle_rad_ = std::atan2(sine, to.axis.dot(from.axis));
  // Of opposite axes `across` is rounding alone, and not across.
  const Vec3 side = across - across.dot(from.axis) * from.axis;
  turns_to_ = side.norm() > 0.0 ? side.normalized() : any_perpendicular(from.axis);
  // Seen from the bit, the second derivative of a point's place q in the plane of the turn is, over the whole way,
  // 2 angle J w - angle² q, where w is the tip's way, turned back as far as the bit has turned, and J a right angle. An
  // eighth of its most is how far chord and arc part. Between its ends J w leaves its chord by no more than its
  // sagitta.
  const Vec3 way = to.tip_mm - from.tip_mm;
  const double forward_mm = way.dot(from.axis), aside_mm = way.dot(turns_to_);
  const double cosine = std::cos(angle_rad_), turned_by = std::sin(angle_rad_);
  const double square = angle_rad_ * angle_rad_, radius_mm = profile.bit.radius_mm();
  double most_mm = 0.0;
  for (const auto& [along_mm, across_mm] :
       {std::pair(-aside_mm, forward_mm),
        std::pair(turned_by * forward_mm - cosine * aside_mm, cosine * forward_mm + turned_by * aside_mm)}) {
    for (const double back_mm : {0.0, profile.bit.length_mm()}) {
      most_mm = std::max(most_mm, std::hypot(2.0 * angle_rad_ * along_mm + square * back_mm,
                                             2.0 * angle_rad_ * std::abs(across_mm) + square * radius_mm));
    }
  }
  const double sagitta_mm = std::hypot(forward_mm, aside_mm) * (1.0 - std::cos(0.5 * angle_rad_));
  bend_mm_ = (most_mm + 2.0 * angle_rad_ * sagitta_mm) / 8.0;
  if (bend_mm_ <= 0.5 * SweepProfile::kStraightSkinMm) return;
  way_ = SweptBit::Way::turning;
  pieces_ = static_cast<std::size_t>(
      std::clamp(std::ceil(std::sqrt(bend_mm_ / (0.5 * SweepProfile::kTurningSkinMm))), 1.0, 1e5));
}

Pose BitMotion::pose(std::size_t piece) const noexcept {
  if (piece == 0) return from_;
  if (piece >= pieces_) return to_;
  return pose_at(static_cast<double>(piece) / static_cast<double>(pieces_));
}

Pose BitMotion::pose_at(double share) const noexcept {
  const double angle = share * angle_rad_;
  const Vec3 axis = std::cos(angle) * from_.axis + std::sin(angle) * turns_to_;
  return {from_.tip_mm + share * (to_.tip_mm - from_.tip_mm), axis.normalized()};
}

}  // namespace spinaltap
