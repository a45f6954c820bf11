#include "vdb/engine/detail/tool_bounds.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace spinaltap::detail {
namespace {

/// Rounding and SweptBit's spare, with room.
constexpr double kSpareMm = 2e-5;

}  // namespace

ToolBounds::ToolBounds(const BitProfile& profile)
    : radius_mm_(profile.radius_mm()),
      cone_slope_(profile.cone_slope()),
      cone_offset_mm_(profile.cone_offset_mm()),
      has_cone_(profile.is_cone_and_cylinder()) {
  double steepest = 0.0;
  for (const ProfilePiece& piece : profile.pieces()) {
    Piece& side = pieces_[count_++];
    side = {piece.begin_mm, piece.end_mm, piece.ball_centre_mm, piece.ball_radius_mm, 0.0, 0.0, 0.0};
    larger_ball_mm_ = std::max(larger_ball_mm_, piece.ball_radius_mm - radius_mm_);
    if (piece.ball_radius_mm > 0.0) continue;
    const double slope = (piece.end_radius_mm - piece.begin_radius_mm) / (piece.end_mm - piece.begin_mm);
    const double cosine = 1.0 / std::sqrt(1.0 + slope * slope);
    side.per_off = cosine;
    side.per_back = -slope * cosine;
    side.at_origin_mm = (slope * piece.begin_mm - piece.begin_radius_mm) * cosine;
    steepest = std::max(steepest, std::abs(slope));
  }
  // A piece of the grown outline stands out of the bit by a few skins, a steep one by as many as it is steep.
  margin_mm_ = SweepProfile::kStraightSkinMm * (3.0 + 4.0 * steepest);
}

double ToolBounds::from_piece_mm(const Piece& piece, const BitPlace& at) {
  if (piece.ball_radius_mm > 0.0) {
    const double along_mm = at.back_mm - piece.ball_centre_mm;
    return std::sqrt(along_mm * along_mm + at.off_mm * at.off_mm) - piece.ball_radius_mm;
  }
  const double side_mm = piece.per_off * at.off_mm + piece.per_back * at.back_mm + piece.at_origin_mm;
  return std::max({side_mm, piece.begin_mm - at.back_mm, at.back_mm - piece.end_mm});
}

double ToolBounds::from_round_mm(const Piece& piece, const BitPlace& at) {
  return piece.ball_radius_mm > 0.0 ? from_piece_mm(piece, at) : piece.per_off * at.off_mm + piece.at_origin_mm;
}

double ToolBounds::from_body_mm(const BitPlace& at) const {
  double nearest_mm = std::numeric_limits<double>::infinity();
  for (const Piece& piece : pieces()) nearest_mm = std::min(nearest_mm, from_piece_mm(piece, at));
  return nearest_mm;
}

PieceBounds::PieceBounds(const ToolBounds& bounds, const BitPlace& at, double radius_mm)
    : count_(static_cast<unsigned>(bounds.pieces().size())) {
  for (unsigned n = 0; n < count_; ++n) {
    from_mm_[n] = ToolBounds::from_piece_mm(bounds.pieces()[n], at) - radius_mm;
    if (from_mm_[n] < least_mm_) {
      least_mm_ = from_mm_[n];
      nearest_ = n;
    }
  }
}

PieceBounds::Near PieceBounds::within(double reach_mm) const {
  Near near{1U << nearest_, 1e30};
  for (unsigned n = 0; n < count_; ++n) {
    if (n == nearest_) continue;
    if (from_mm_[n] <= reach_mm) {
      near.pieces |= 1U << n;
    } else {
      near.rest_mm = std::min(near.rest_mm, from_mm_[n]);
    }
  }
  return near;
}

SweptBounds::SweptBounds(std::span<const SweptBit> pieces, const ToolBounds& bounds)
    : pieces_(pieces), bounds_(bounds) {
  const Pose &from = pieces.front().from(), &to = pieces.back().to();
  const Vec3 way = from.tip_mm - to.tip_mm;
  line_ = {to.tip_mm, to.axis, (to.axis - from.axis).norm(), pieces.front().edge_mm(), way.norm()};
  const double along_mm = way.dot(line_.axis);
  way_mm_ = way.norm();
  across_mm_ = std::sqrt(std::max(0.0, way_mm_ * way_mm_ - along_mm * along_mm));
  // Where a bit draws back, points were further back before, where a cone is wider.
  back_mm_ = std::max(0.0, along_mm);
  angle_ = 2.0 * std::asin(std::min(1.0, 0.5 * line_.turned));
  per_piece_ = 1.0 / static_cast<double>(pieces.size());
}

SweptBounds::Reach SweptBounds::reach_of_ball(const BitPlace& at, double radius_mm) const {
  const double arc_mm = angle_ * (std::abs(at.back_mm) + at.off_mm + radius_mm + way_mm_);
  const double turned_mm = arc_mm + line_.edge_mm + kSpareMm;
  const double across_mm = across_mm_ + turned_mm;
  // Twice the edge: the bounds at both ends of a way leave one each.
  const double edges_mm = 2.0 * line_.edge_mm + kSpareMm;
  const double piece_mm = (way_mm_ + arc_mm) * per_piece_ + edges_mm;
  return {across_mm, across_mm + bounds_.cone_slope() * (back_mm_ + turned_mm), way_mm_ + turned_mm + line_.edge_mm,
          piece_mm};
}

FreeMove SweptBounds::free_of_ball(const BitPlace& at, double radius_mm, double body_mm, const Reach& reach,
                                   double min_mm) const {
  const double cylinder_mm = bounds_.from_cylinder_mm(at) - radius_mm;
  if (cylinder_mm >= reach.cylinder + min_mm) return {cylinder_mm - bounds_.margin_mm(), 0.0, 0.0};
  if (bounds_.has_cone()) {
    const double slope = bounds_.cone_slope();
    const double cone_mm = bounds_.from_cone_mm(at) - radius_mm * (1.0 + slope);
    if (cone_mm >= reach.cone + min_mm) return {cone_mm - bounds_.margin_mm(), slope, 0.0};
  }
  if (body_mm >= reach.body + min_mm) return {body_mm - bounds_.margin_mm(), 1.0, 1.0};
  return {};
}

FreeMove SweptBounds::to_one_side(const Vec3& centre_mm, double radius_mm, unsigned pieces) const {
  FreeMove free{-1.0, 1.0, 1.0};
  if (!std::has_single_bit(pieces)) return free;
  const ToolBounds::Piece& piece = bounds_.pieces()[static_cast<std::size_t>(std::countr_zero(pieces))];
  Vec3 from = centre_mm - line_.tip_mm;
  if (piece.ball_radius_mm > 0.0) {
    from += piece.ball_centre_mm * line_.axis;
  } else if (piece.per_back == 0.0) {
    from -= from.dot(line_.axis) * line_.axis;
    free.axial = 0.0;
  } else {
    return free;
  }
  const double from_mm = from.norm();
  // Near by, most moves lead to some of its points.
  constexpr double kWorthIt = 0.7;
  if (radius_mm < kWorthIt * from_mm) {
    free.side = from / from_mm;
    free.angle_sine = radius_mm / from_mm;
  } else if (free.axial == 0.0) {
    free.angle_sine = 1.0;
  }
  return free;
}

bool SweptBounds::holds_ball(const BitPlace& at, double radius_mm) const {
  const BitProfile& profile = pieces_.front().profile();
  return profile.contains_inlined(at.back_mm, at.off_mm * at.off_mm) &&
         profile.distance_mm(at.back_mm, at.off_mm) < -radius_mm - kSpareMm;
}

}  // namespace spinaltap::detail
