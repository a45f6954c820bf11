#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

#include "core/tool/drill_bit.h"

namespace spinaltap {

/// A stretch of a bit's outline: a frustum, or a slice of a ball with its centre on the axis.
struct ProfilePiece {
  double begin_mm = 0.0;  ///< back from the tip
  double end_mm = 0.0;
  double begin_radius_mm = 0.0;
  double end_radius_mm = 0.0;
  double ball_centre_mm = 0.0;  ///< back from the tip
  double ball_radius_mm = 0.0;  ///< 0: a frustum
  /// radius² = square[0] + square[1] w + square[2] w² at w back from the tip.
  std::array<double, 3> square{};

  [[gnu::always_inline]] double radius_squared_mm2(double back_mm) const {
    return square[0] + back_mm * (square[1] + back_mm * square[2]);
  }
  double widest_mm() const {
    const bool holds_centre = ball_radius_mm > 0.0 && begin_mm <= ball_centre_mm && ball_centre_mm <= end_mm;
    return holds_centre ? ball_radius_mm : std::max(begin_radius_mm, end_radius_mm);
  }
};

/// The outline of a bit in the half plane of (back from the tip, off the axis), in mm.
class BitProfile {
 public:
  /// Throws Error as check_bit does, and on a plate (see PlateBox), which has no outline.
  explicit BitProfile(const DrillBit& bit);

  double length_mm() const { return length_mm_; }
  /// Where the bit is widest.
  double radius_mm() const { return radius_mm_; }
  /// In order from the tip to the base, one where the other ends.
  std::span<const ProfilePiece> pieces() const { return {pieces_.data(), count_}; }
  /// The pieces, larger by `skin_mm` to all sides, at edges by up to 2.7 times as much.
  BitProfile grown(double skin_mm) const;
  /// Whether it is nowhere narrower than before its widest place, and nowhere wider than before behind it.
  bool widens_to_one_place() const { return widens_to_one_place_; }
  /// What a bit that widens to one place sweeps on a way of `way_mm` forward along its axis, from the tip at the end of
  /// the way.
  BitProfile lengthened(double way_mm) const;

  /// Whether the bit holds points there. The surface counts as inside. For a drill this is the paper's algorithm 1,
  /// with the cone's factor the right way up: the allowed radius is (1 - alpha) * length / tip_length of the bit's
  /// radius, where alpha runs from 0 at the base to 1 at the tip.
  bool contains(double back_mm, double off_axis_squared_mm2) const noexcept;
  /// The same within loops, compiled with its caller's flags, which may round otherwise: for the library's own.
  [[gnu::always_inline]] bool contains_inlined(double back_mm, double off_axis_squared_mm2) const noexcept {
    for (std::size_t n = 0; n < count_; ++n) {
      const ProfilePiece& piece = pieces_[n];
      if (back_mm >= piece.begin_mm && back_mm <= piece.end_mm &&
          off_axis_squared_mm2 <= piece.radius_squared_mm2(back_mm)) {
        return true;
      }
    }
    return false;
  }

  /// Where the bit is widest between two places back from the tip; below 0 where it is not between them at all.
  double widest_mm(double from_back_mm, double to_back_mm) const noexcept;

  /// Exact signed distance to the surface; negative inside.
  double distance_mm(double back_mm, double off_axis_mm) const noexcept;

  /// The bit lies within the cone of radius cone_offset_mm() + cone_slope() * w, and within its widest radius. Where
  /// is_cone_and_cylinder(), it is all that both share between tip and base: the bound is tight.
  double cone_slope() const { return cone_slope_; }
  double cone_offset_mm() const { return cone_offset_mm_; }
  bool is_cone_and_cylinder() const { return is_cone_and_cylinder_; }

 private:
  BitProfile() = default;
  void add_frustum(double begin_mm, double end_mm, double begin_radius_mm, double end_radius_mm);
  void add_ball(double begin_mm, double end_mm, double centre_mm, double radius_mm);
  void add_outline(std::span<const OutlinePoint> outline);
  void add_grown(const ProfilePiece& piece, double skin_mm);

  std::size_t count_ = 0;
  double length_mm_ = 0.0;
  double radius_mm_ = 0.0;
  double cone_slope_ = 0.0;
  double cone_offset_mm_ = 0.0;
  bool is_cone_and_cylinder_ = false;
  bool widens_to_one_place_ = true;
  /// Of a stretch that is grown there may be two.
  std::array<ProfilePiece, 2 * kMaxStretches> pieces_{};
};

/// Exact signed distance (mm) from p to the bit's surface at `pose`; negative inside.
double bit_distance_mm(const BitProfile& bit, const Pose& pose, const Vec3& p);

}  // namespace spinaltap
