#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <span>

#include "core/tool/swept_bit.h"
#include "vdb/engine/detail/move_certificates.h"

namespace spinaltap::detail {

/// Where a point is, seen from a bit.
struct BitPlace {
  double back_mm = 0.0;  ///< from the tip
  double off_mm = 0.0;   ///< the axis
};

/// Quick lower bounds of the distance to a tool, each with what of the tool's moves can make it smaller. They say
/// nothing (are not above 0) inside of what they bound the tool by.
class ToolBounds {
 public:
  explicit ToolBounds(const BitProfile& profile);

  /// From the cylinder of the tool's widest radius: only moves across the axis count.
  double from_cylinder_mm(const BitPlace& at) const { return at.off_mm - radius_mm_; }
  /// From the cone that is a drill's tip, counted across the axis: of the advance, the slope counts too.
  double from_cone_mm(const BitPlace& at) const { return at.off_mm - cone_offset_mm_ - cone_slope_ * at.back_mm; }
  bool has_cone() const { return has_cone_; }
  double cone_slope() const { return cone_slope_; }
  /// From frusta and balls, of which the tool is made: all moves count.
  double from_body_mm(const BitPlace& at) const;
  /// What bounds must exceed before SweptBit on a straight way, which grows the bit by a skin, surely holds nothing.
  double margin_mm() const { return margin_mm_; }

  struct Piece {
    double begin_mm, end_mm;
    double ball_centre_mm, ball_radius_mm;   ///< radius 0: a frustum
    double per_off, per_back, at_origin_mm;  ///< distance from the frustum's side
  };
  static double from_piece_mm(const Piece& piece, const BitPlace& at);
  /// The same from a ball, or from a cylinder without ends: along the directions that one-sided certificates count.
  static double from_round_mm(const Piece& piece, const BitPlace& at);
  static constexpr std::size_t kMaxPieces = kMaxStretches;
  std::span<const Piece> pieces() const { return {pieces_.data(), count_}; }
  double radius_mm() const { return radius_mm_; }
  /// Whether one piece is the cylinder of the tool's widest radius.
  bool is_widest(unsigned pieces) const {
    const Piece& piece = pieces_[static_cast<std::size_t>(std::countr_zero(pieces))];
    return piece.ball_radius_mm == 0.0 && -piece.at_origin_mm == radius_mm_;
  }
  double cone_offset_mm() const { return cone_offset_mm_; }
  /// How much larger than the tool's widest radius a ball is that a flat arc is of.
  double larger_ball_mm() const { return larger_ball_mm_; }

 private:
  std::size_t count_ = 0;
  double radius_mm_, cone_slope_, cone_offset_mm_;
  bool has_cone_;
  double margin_mm_;
  double larger_ball_mm_ = 0.0;
  std::array<Piece, kMaxPieces> pieces_{};
};

/// Least bounds of a ball from each of a tool's pieces.
class PieceBounds {
 public:
  PieceBounds(const ToolBounds& bounds, const BitPlace& at, double radius_mm);

  double least_mm() const { return least_mm_; }
  unsigned nearest() const { return nearest_; }
  /// A bit for each piece that may lie within `reach_mm`, the nearest at least; and the least bound from the others.
  struct Near {
    unsigned pieces;
    double rest_mm;
  };
  Near within(double reach_mm) const;

 private:
  std::array<double, ToolBounds::kMaxPieces> from_mm_;
  unsigned count_, nearest_ = 0;
  double least_mm_ = 1e30;
};

/// A swept bit as boxes and points are classified against it: pieces of a way that follow one another evenly.
class SweptBounds {
 public:
  /// What it is given must outlive it; one piece at least.
  SweptBounds(std::span<const SweptBit> pieces, const ToolBounds& bounds);

  std::span<const SweptBit> pieces() const { return pieces_; }
  /// Whether the bit passes p.
  [[gnu::always_inline]] bool contains_inlined(const Vec3& p) const noexcept {
    for (const SweptBit& piece : pieces_) {
      if (piece.contains_inlined(p)) return true;
    }
    return false;
  }
  const ToolBounds& bounds() const { return bounds_; }
  const BitLine& line() const { return line_; }

  /// Seen from the bit at the end of its way.
  BitPlace place(const Vec3& p) const {
    const Vec3 q = p - line_.tip_mm;
    const double back_mm = -q.dot(line_.axis);
    return {back_mm, std::sqrt(std::max(0.0, q.squaredNorm() - back_mm * back_mm))};
  }
  /// How near its bounds, in mm, a point must be for the bit to have passed it. By how far it moved, seen from the bit:
  /// with the tip, and as far as turning takes it, the more the further it lies from the tip.
  struct Reach {
    double cylinder, cone;
    double body;   ///< the bounds at both ends of the way, together
    double piece;  ///< the bounds at both ends of a piece of it, together
    bool holds(double from_cylinder_mm, double from_cone_mm) const {
      return from_cylinder_mm <= cylinder && from_cone_mm <= cone;
    }
  };
  /// Of points within `radius_mm` of `at`.
  Reach reach_of_ball(const BitPlace& at, double radius_mm) const;
  /// How far the bit may move before it can touch a ball around `at` that it has not passed: nothing where it may have
  /// passed it, or where that is less than `min_mm`.
  FreeMove free_of_ball(const BitPlace& at, double radius_mm, double min_mm) const {
    return free_of_ball(at, radius_mm, bounds_.from_body_mm(at) - radius_mm, reach_of_ball(at, radius_mm), min_mm);
  }
  /// The same where the ball's bound from the body and its reach are known.
  FreeMove free_of_ball(const BitPlace& at, double radius_mm, double body_mm, const Reach& reach, double min_mm) const;
  /// A certificate, still without its lengths, of a ball that lies to one side of a ball or a cylinder: of `pieces`
  /// where that is one alone. It has no side where there is none. Lengths are to be by from_round_mm().
  FreeMove to_one_side(const Vec3& centre_mm, double radius_mm, unsigned pieces) const;
  /// Whether the bit holds all of a ball around `at` at the end of its way.
  bool holds_ball(const BitPlace& at, double radius_mm) const;

 private:
  std::span<const SweptBit> pieces_;
  const ToolBounds& bounds_;
  BitLine line_;
  double way_mm_;  ///< of the tip, and its parts across the axis and back along it, at most
  double across_mm_;
  double back_mm_;
  double angle_;      ///< of the turn, at most
  double per_piece_;  ///< how much of the way a piece is
};

}  // namespace spinaltap::detail
