#pragma once

#include <cstddef>

#include "core/tool/bit_profile.h"

namespace spinaltap {

/// A bit's outline, and the larger ones that decide what it sweeps.
struct SweepProfile {
  /// How much larger to all sides, at edges by up to kEdge times as much.
  static constexpr double kStraightSkinMm = 1e-6;
  static constexpr double kTurningSkinMm = 1e-3;
  static constexpr double kEdge = 2.7;

  explicit SweepProfile(const BitProfile& profile);

  BitProfile bit;
  BitProfile straight;  ///< for straight ways, and those that turn so little that its skin covers it
  BitProfile turning;
};

/// A bit on its way from one pose to another: the body that all engines remove points by.
///
/// Seen from the bit, a point moves along the chord between where the bit has it at the first pose and where at the
/// last; a point is removed when that chord meets the bit. A straight way is swept exactly; of a turning one, pieces
/// are taken so short that chord and arc differ by less than half a skin (see BitMotion). The bit is larger by a skin
/// to all sides: so nothing survives that the bit passed, and rounding decides nothing where a bit's wall lies on a
/// ring of points. On a straight way the skin is 1 nm, and what is removed lies within 3 nm of what a perfect bit would
/// sweep; on a turning one it is 1 um, and that within 3 um: a thinner one would need many more pieces.
///
/// Chords against quadrics: every piece of the outline has radius² quadratic in the way back from the tip, so the
/// chord's excess over it is a quadratic, whose least value over the stretch decides.
class SweptBit {
 public:
  enum class Way { straight, turning };

  /// `profile` must outlive the object. Poses in any one frame, mm; axes unit.
  SweptBit(const SweepProfile& profile, const Pose& from, const Pose& to, Way way = Way::straight) noexcept;

  const BitProfile& profile() const { return *profile_; }
  const Pose& from() const { return from_; }
  const Pose& to() const { return to_; }
  /// Two directions across the axis, and back along it, in rows: as the bit sees points at either end of its way.
  const Mat3& from_rows() const { return from_rows_; }
  const Mat3& to_rows() const { return to_rows_; }

  /// Whether the bit passes p. Quick tests come first; they never differ from the exact one.
  bool contains(const Vec3& p) const noexcept;
  /// The same within loops, compiled with its caller's flags, which may round otherwise: for the library's own.
  [[gnu::always_inline]] bool contains_inlined(const Vec3& p) const noexcept {
    const Vec3 at_end = seen_by(to_rows_, p, to_.tip_mm);
    const double off_axis_squared = at_end.x() * at_end.x() + at_end.y() * at_end.y();
    if (profile_->contains_inlined(at_end.z(), off_axis_squared)) return true;
    if (is_beyond(at_end.z(), off_axis_squared)) return false;
    return chord_meets(seen_by(from_rows_, p, from_.tip_mm), at_end);
  }

  /// By how much more than a straight way's the skin may reach beyond the bit, mm.
  double edge_mm() const { return edge_mm_; }
  /// How far, at most, a point that the bit reaches on its way moves across the bit's axis and back along it, seen from
  /// the bit, between any moment of the way and its end, mm; with edge_mm().
  double across_mm() const { return across_mm_; }
  double back_mm() const { return back_mm_; }
  /// The same forward: how much further forward points may have been before, seen from the bit.
  double forth_mm() const { return forth_mm_; }

  /// Lowest and highest coordinate along z that the bit reaches, with a little to spare.
  double lowest_z_mm() const { return lowest_z_mm_; }
  double highest_z_mm() const { return highest_z_mm_; }

 private:
  /// rows * (p - tip). Eigen's own product is a function, of which a linker may take the one from a user's compiler.
  [[gnu::always_inline]] static Vec3 seen_by(const Mat3& rows, const Vec3& p, const Vec3& tip_mm) noexcept {
    const double x = p[0] - tip_mm[0], y = p[1] - tip_mm[1], z = p[2] - tip_mm[2];
    return {rows(0, 0) * x + rows(0, 1) * y + rows(0, 2) * z, rows(1, 0) * x + rows(1, 1) * y + rows(1, 2) * z,
            rows(2, 0) * x + rows(2, 1) * y + rows(2, 2) * z};
  }
  [[gnu::always_inline]] bool is_beyond(double back_mm, double off_axis_squared_mm2) const noexcept {
    if (back_mm < min_back_mm_ || back_mm > max_back_mm_ || off_axis_squared_mm2 > max_off_axis_squared_mm2_) {
      return true;
    }
    const double allowed_mm = cone_mm_ + profile_->cone_slope() * back_mm;
    return allowed_mm < 0.0 || off_axis_squared_mm2 > allowed_mm * allowed_mm;
  }
  bool chord_meets(const Vec3& begin, const Vec3& end) const noexcept;

  const BitProfile* profile_;
  const BitProfile* grown_;
  Pose from_;
  Pose to_;
  Mat3 from_rows_;
  Mat3 to_rows_;
  double edge_mm_ = 0.0;
  double across_mm_ = 0.0;
  double back_mm_ = 0.0;
  double forth_mm_ = 0.0;
  double min_back_mm_ = 0.0;
  double max_back_mm_ = 0.0;
  double max_off_axis_squared_mm2_ = 0.0;
  double cone_mm_ = 0.0;  ///< the bounding cone's offset, with all that the way adds
  double lowest_z_mm_ = 0.0;
  double highest_z_mm_ = 0.0;
};

/// The way between two poses: the tip goes straight, the axis turns evenly, in pieces short enough for SweptBit.
class BitMotion {
 public:
  /// `profile` must outlive the object and its pieces.
  BitMotion(const SweepProfile& profile, const Pose& from, const Pose& to) noexcept;

  std::size_t piece_count() const { return pieces_; }
  SweptBit piece(std::size_t number) const noexcept { return {*profile_, pose(number), pose(number + 1), way_}; }
  /// Pose after the first `piece` pieces; the first and the last are exactly those given.
  Pose pose(std::size_t piece) const noexcept;
  /// Pose at a share of the way within [0, 1].
  Pose pose_at(double share) const noexcept;
  /// How far chord and arc part, at most, where the whole way is taken for one piece: of n they part by 1 / n² of it.
  double bend_mm() const { return bend_mm_; }

 private:
  const SweepProfile* profile_;
  Pose from_;
  Pose to_;
  Vec3 turns_to_;  ///< unit, at right angles to the first axis, in the plane of the turn
  double angle_rad_ = 0.0;
  double bend_mm_ = 0.0;
  SweptBit::Way way_ = SweptBit::Way::straight;
  std::size_t pieces_ = 1;
};

}  // namespace spinaltap
