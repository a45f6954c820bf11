#include "core/tool/bit_profile.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "core/tool/detail/outline_ball.h"

namespace spinaltap {
namespace {

using Vec2 = Eigen::Vector2d;

/// Squared distance from q to the segment a-b, in the plane.
double to_segment_squared(const Vec2& q, const Vec2& a, const Vec2& b) {
  const Vec2 along = b - a;
  const double squared = along.squaredNorm();
  if (!(squared > 0.0)) return (q - a).squaredNorm();
  const double t = std::clamp((q - a).dot(along) / squared, 0.0, 1.0);
  return (q - a - t * along).squaredNorm();
}

/// Squared distance from q to a piece's own stretch of outline.
double to_piece_squared(const Vec2& q, const ProfilePiece& piece) {
  const Vec2 begin(piece.begin_mm, piece.begin_radius_mm);
  const Vec2 end(piece.end_mm, piece.end_radius_mm);
  if (piece.ball_radius_mm == 0.0) return to_segment_squared(q, begin, end);
  const Vec2 centre(piece.ball_centre_mm, 0.0);
  const double to_centre_mm = (q - centre).norm();
  // The way out from the centre meets the circle within the stretch, or one of its ends is nearest.
  const double meets_mm =
      to_centre_mm > 0.0 ? piece.ball_centre_mm + piece.ball_radius_mm * (q.x() - piece.ball_centre_mm) / to_centre_mm
                         : piece.begin_mm;
  if (meets_mm >= piece.begin_mm && meets_mm <= piece.end_mm) {
    const double off_mm = to_centre_mm - piece.ball_radius_mm;
    return off_mm * off_mm;
  }
  return std::min((q - begin).squaredNorm(), (q - end).squaredNorm());
}

}  // namespace

void BitProfile::add_frustum(double begin_mm, double end_mm, double begin_radius_mm, double end_radius_mm) {
  if (!(end_mm > begin_mm)) return;
  const double slope = (end_radius_mm - begin_radius_mm) / (end_mm - begin_mm);
  const double at_tip_mm = begin_radius_mm - slope * begin_mm;
  pieces_[count_++] = {begin_mm,
                       end_mm,
                       begin_radius_mm,
                       end_radius_mm,
                       0.0,
                       0.0,
                       {at_tip_mm * at_tip_mm, 2.0 * at_tip_mm * slope, slope * slope}};
}

void BitProfile::add_ball(double begin_mm, double end_mm, double centre_mm, double radius_mm) {
  const double c = centre_mm;
  const auto radius_at = [&](double w) { return std::sqrt(std::max(0.0, radius_mm * radius_mm - (w - c) * (w - c))); };
  pieces_[count_++] = {begin_mm,
                       end_mm,
                       radius_at(begin_mm),
                       radius_at(end_mm),
                       centre_mm,
                       radius_mm,
                       {radius_mm * radius_mm - c * c, 2.0 * c, -1.0}};
}

void BitProfile::add_outline(std::span<const OutlinePoint> outline) {
  for (std::size_t n = 1; n < outline.size(); ++n) {
    const OutlinePoint& from = outline[n - 1];
    const OutlinePoint& to = outline[n];
    if (!to.is_arc) {
      add_frustum(from.back_mm, to.back_mm, from.radius_mm, to.radius_mm);  // a flat face is where pieces differ
      continue;
    }
    const detail::OutlineBall ball = detail::ball_through(from, to);
    const double at_tip_mm2 = from.radius_mm * from.radius_mm + from.back_mm * (from.back_mm - 2.0 * ball.centre_mm);
    pieces_[count_++] = {from.back_mm,
                         to.back_mm,
                         from.radius_mm,
                         to.radius_mm,
                         ball.centre_mm,
                         ball.radius_mm,
                         {at_tip_mm2, 2.0 * ball.centre_mm, -1.0}};
  }
  // Radii in order from the tip: they rise to the widest and fall from there.
  double before_mm = 0.0;
  bool is_past = false;
  for (const ProfilePiece& piece : pieces()) {
    for (const double radius_mm : {piece.begin_radius_mm, piece.widest_mm(), piece.end_radius_mm}) {
      if (radius_mm > before_mm && is_past) widens_to_one_place_ = false;
      is_past = is_past || radius_mm < before_mm;
      before_mm = radius_mm;
    }
  }
  // The outline of a drill is bounded like one.
  const ProfilePiece& tip = pieces_[0];
  const auto is_straight = [](const ProfilePiece& piece) { return piece.ball_radius_mm == 0.0; };
  if (count_ == 2 && is_straight(tip) && is_straight(pieces_[1]) && tip.begin_radius_mm < tip.end_radius_mm &&
      tip.end_radius_mm == pieces_[1].begin_radius_mm && tip.end_radius_mm == pieces_[1].end_radius_mm) {
    cone_offset_mm_ = tip.begin_radius_mm;
    cone_slope_ = (radius_mm_ - tip.begin_radius_mm) / tip.end_mm;
    is_cone_and_cylinder_ = true;
  }
}

BitProfile::BitProfile(const DrillBit& bit) : length_mm_(bit.length_mm), radius_mm_(bit.radius_mm()) {
  check_bit(bit);
  const double tip_mm = 0.5 * bit.tip_diameter_mm;
  const double shank_mm = 0.5 * bit.shank_diameter_mm;
  cone_offset_mm_ = radius_mm_;
  switch (bit.shape) {
    case BitShape::drill:
      add_frustum(0.0, bit.tip_length_mm, tip_mm, radius_mm_);
      add_frustum(bit.tip_length_mm, bit.length_mm, radius_mm_, radius_mm_);
      cone_offset_mm_ = tip_mm;
      cone_slope_ = (radius_mm_ - tip_mm) / bit.tip_length_mm;
      is_cone_and_cylinder_ = true;
      break;
    case BitShape::round_burr: {
      // The ball ends where it meets the shank, or the bit does.
      const double neck_mm = radius_mm_ + std::sqrt(radius_mm_ * radius_mm_ - shank_mm * shank_mm);
      const double ball_end_mm = std::min(neck_mm, bit.length_mm);
      add_ball(0.0, ball_end_mm, radius_mm_, radius_mm_);
      if (shank_mm > 0.0) add_frustum(ball_end_mm, bit.length_mm, shank_mm, shank_mm);
      if (shank_mm == 0.0) length_mm_ = ball_end_mm;
      break;
    }
    case BitShape::conical_burr:
      add_frustum(0.0, bit.tip_length_mm, tip_mm, radius_mm_);
      if (shank_mm > 0.0) add_frustum(bit.tip_length_mm, bit.length_mm, shank_mm, shank_mm);
      if (shank_mm == 0.0) length_mm_ = bit.tip_length_mm;
      break;
    case BitShape::tapered_screw: {
      const double neck_mm = bit.tip_length_mm < bit.length_mm ? tip_mm : radius_mm_;
      add_frustum(0.0, bit.tip_length_mm, 0.0, neck_mm);
      add_frustum(bit.tip_length_mm, bit.length_mm, tip_mm, radius_mm_);
      break;
    }
    case BitShape::profile:
      add_outline(bit.outline);
      break;
    case BitShape::plate:
      fail("expected a body of revolution, found a plate");
  }
}

void BitProfile::add_grown(const ProfilePiece& piece, double skin_mm) {
  // What lies within a skin of a piece lies below its wall moved out by the skin, and no further out than its wider end
  // by a skin. A steep wall needs that cap: lengthened by a skin it would reach far beyond.
  const double begin_mm = piece.begin_mm - skin_mm;
  const double end_mm = piece.end_mm + skin_mm;
  const double begin_cap_mm = piece.begin_radius_mm + skin_mm;
  const double end_cap_mm = piece.end_radius_mm + skin_mm;
  if (piece.ball_radius_mm > 0.0) {
    const double centre_mm = piece.ball_centre_mm;
    const double radius_mm = piece.ball_radius_mm + skin_mm;
    double ball_begin_mm = begin_mm;
    double ball_end_mm = end_mm;
    if (piece.begin_mm - centre_mm > piece.begin_radius_mm) {
      ball_begin_mm = centre_mm + std::sqrt(radius_mm * radius_mm - begin_cap_mm * begin_cap_mm);
    }
    if (centre_mm - piece.end_mm > piece.end_radius_mm) {
      ball_end_mm = centre_mm - std::sqrt(radius_mm * radius_mm - end_cap_mm * end_cap_mm);
    }
    add_frustum(begin_mm, ball_begin_mm, begin_cap_mm, begin_cap_mm);
    add_ball(ball_begin_mm, ball_end_mm, centre_mm, radius_mm);
    add_frustum(ball_end_mm, end_mm, end_cap_mm, end_cap_mm);
    return;
  }
  constexpr double kSteep = 1.0;
  const double slope = (piece.end_radius_mm - piece.begin_radius_mm) / (piece.end_mm - piece.begin_mm);
  const double out_mm = skin_mm * std::sqrt(1.0 + slope * slope);
  const double begin_radius_mm = piece.begin_radius_mm - slope * skin_mm + out_mm;
  const double end_radius_mm = piece.end_radius_mm + slope * skin_mm + out_mm;
  if (slope > kSteep) {
    const double cap_mm = piece.end_mm - (out_mm - skin_mm) / slope;
    add_frustum(begin_mm, cap_mm, begin_radius_mm, end_cap_mm);
    add_frustum(cap_mm, end_mm, end_cap_mm, end_cap_mm);
  } else if (slope < -kSteep) {
    const double cap_mm = piece.begin_mm - (out_mm - skin_mm) / slope;
    add_frustum(begin_mm, cap_mm, begin_cap_mm, begin_cap_mm);
    add_frustum(cap_mm, end_mm, begin_cap_mm, end_radius_mm);
  } else {
    add_frustum(begin_mm, end_mm, begin_radius_mm, end_radius_mm);
  }
}

BitProfile BitProfile::grown(double skin_mm) const {
  BitProfile larger;
  for (const ProfilePiece& piece : pieces()) larger.add_grown(piece, skin_mm);
  larger.length_mm_ = length_mm_ + skin_mm;
  larger.radius_mm_ = 0.0;
  for (const ProfilePiece& piece : larger.pieces()) {
    larger.radius_mm_ = std::max(larger.radius_mm_, piece.widest_mm());
  }
  larger.cone_offset_mm_ = larger.radius_mm_;
  return larger;
}

BitProfile BitProfile::lengthened(double way_mm) const {
  // Behind the widest place the bit is no wider again: there a cylinder comes between.
  BitProfile longer;
  const auto add = [&](const ProfilePiece& piece, double begin_mm, double end_mm, double shift_mm) {
    if (!(end_mm > begin_mm)) return;
    if (piece.ball_radius_mm > 0.0) {
      longer.add_ball(begin_mm + shift_mm, end_mm + shift_mm, piece.ball_centre_mm + shift_mm, piece.ball_radius_mm);
    } else {
      longer.add_frustum(begin_mm + shift_mm, end_mm + shift_mm, piece.begin_radius_mm, piece.end_radius_mm);
    }
  };
  bool is_past = false;
  for (const ProfilePiece& piece : pieces()) {
    const bool is_widest = !is_past && piece.widest_mm() >= radius_mm_;
    double widest_mm = piece.end_radius_mm >= radius_mm_ ? piece.end_mm : piece.begin_mm;
    if (piece.ball_radius_mm > 0.0) widest_mm = std::clamp(piece.ball_centre_mm, piece.begin_mm, piece.end_mm);
    add(piece, piece.begin_mm, is_widest ? widest_mm : piece.end_mm, is_past ? way_mm : 0.0);
    if (!is_widest) continue;
    longer.add_frustum(widest_mm, widest_mm + way_mm, radius_mm_, radius_mm_);
    add(piece, widest_mm, piece.end_mm, way_mm);
    is_past = true;
  }
  longer.length_mm_ = length_mm_ + way_mm;
  longer.radius_mm_ = radius_mm_;
  longer.cone_slope_ = cone_slope_;
  longer.cone_offset_mm_ = cone_offset_mm_;
  longer.is_cone_and_cylinder_ = is_cone_and_cylinder_;
  return longer;
}

double BitProfile::widest_mm(double from_back_mm, double to_back_mm) const noexcept {
  double widest_squared = -1.0;
  for (const ProfilePiece& piece : pieces()) {
    const double begin_mm = std::max(from_back_mm, piece.begin_mm);
    const double end_mm = std::min(to_back_mm, piece.end_mm);
    if (!(begin_mm <= end_mm)) continue;
    widest_squared = std::max({widest_squared, piece.radius_squared_mm2(begin_mm), piece.radius_squared_mm2(end_mm)});
    if (piece.ball_radius_mm > 0.0) {
      widest_squared =
          std::max(widest_squared, piece.radius_squared_mm2(std::clamp(piece.ball_centre_mm, begin_mm, end_mm)));
    }
  }
  return widest_squared < 0.0 ? -1.0 : std::sqrt(widest_squared);
}

double BitProfile::distance_mm(double back_mm, double off_axis_mm) const noexcept {
  const Vec2 q(back_mm, off_axis_mm);
  // Flat ends, and the step where a piece begins with another radius than the one before ended with.
  double squared_mm2 = std::numeric_limits<double>::infinity();
  double before_mm = 0.0;
  for (const ProfilePiece& piece : pieces()) {
    if (piece.begin_radius_mm != before_mm) {
      const Vec2 begin(piece.begin_mm, piece.begin_radius_mm);
      squared_mm2 = std::min(squared_mm2, to_segment_squared(q, Vec2(piece.begin_mm, before_mm), begin));
    }
    squared_mm2 = std::min(squared_mm2, to_piece_squared(q, piece));
    before_mm = piece.end_radius_mm;
  }
  const double base_mm = pieces().back().end_mm;
  squared_mm2 = std::min(squared_mm2, to_segment_squared(q, Vec2(base_mm, before_mm), Vec2(base_mm, 0.0)));
  const double distance_mm = std::sqrt(squared_mm2);
  return contains(back_mm, off_axis_mm * off_axis_mm) ? -distance_mm : distance_mm;
}

bool BitProfile::contains(double back_mm, double off_axis_squared_mm2) const noexcept {
  return contains_inlined(back_mm, off_axis_squared_mm2);
}

double bit_distance_mm(const BitProfile& bit, const Pose& pose, const Vec3& p) {
  const Vec3 from_tip_mm = p - pose.tip_mm;
  const double back_mm = -from_tip_mm.dot(pose.axis);
  return bit.distance_mm(back_mm, (from_tip_mm + back_mm * pose.axis).norm());
}

}  // namespace spinaltap
