#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/base/geometry.h"
#include "vdb/engine/detail/move_kernels.h"

namespace spinaltap::detail {

/// How far a bit may move before it can touch the points of a box.
struct FreeMove {
  double free_mm = -1.0;  ///< none where not above 0
  double forward = 0.0;   ///< how much of the bit's advance along its axis counts
  double backward = 0.0;  ///< and of its retreat

  // Where the nearest piece of the tool is a ball or a cylinder, and the whole box lies to one side of it:
  Vec3 side = Vec3::Zero();  ///< unit, from the piece to the box, in the boxes' frame; zero: moves to all sides count
  static constexpr double kNoSide = 2.0;
  double angle_sine = kNoSide;  ///< by how much directions from the piece to the box's points may differ from it
  double axial = 1.0;     ///< how much of moves along the axis counts: none of a cylinder, which slides along itself
  double rest_mm = 1e30;  ///< how far the bit may move to any side before another piece can touch them

  bool has_side() const { return angle_sine <= 1.0; }
};

/// A bit's axis at the end of a step, as certificates are checked against it.
struct BitLine {
  Vec3 tip_mm = Vec3::Zero();  ///< path-local
  Vec3 axis = Vec3::UnitZ();   ///< unit, from the base to the tip
  double turned = 0.0;         ///< |difference of the axes| over the step
  double edge_mm = 0.0;        ///< of the step, see SweptBit
  double way_mm = 0.0;         ///< of the tip, over the step; asked for where the step turns
};

/// For each of many boxes of one size, how far the bit may move before it can touch an occupied point there.
///
/// A box's certificate was made at some line of the axis, a' where it is a now. For every point p within h of the box's
/// centre c, whose foot on the axis is F, the vector from the axis to p changes across the old axis by at most
///   |F - F'| + |a - a'| |p - F|,   |p - F| <= h + |c - F|,
/// and p's place along the axis by at most that of c and h |a - a'|. A step's chord (see SweptBit) between two ends
/// parts from both by no more than the step's own turn times |p - F|. So the certificate holds while
///   |F - F'| + ((|a - a'| + turned) (h + |c - F|) + edge) (1 + 2 forward) + what counts of the way along  <  free.
/// All terms but the turn are convex along a step: what holds at both ends holds between.
///
/// Of a ball or a cylinder, the distance of p falls by no more than the part of the move m that leads towards p: u m,
/// with u the unit vector from the piece's centre or axis to p when the certificate was made. Where all u of a box lie
/// within an angle of `side`, the most of u m is |m| where m does too, else |m| cos(m's angle to `side`, less that
/// angle), which may be below 0. It takes the place of |F - F'| and the way along; turns count threefold, as they move
/// p across the axis, along it, and turn u; of a cylinder, which slides along itself, the part along the axis does not
/// count at all. Other pieces of the tool, which are further off, count moves to all sides.
/// As it is convex too and does not fall faster than |m|, a node's certificate that counts moves to all sides holds for
/// it. A step that turns has an edge and a turn of its own at its begin too, of which the check at the end of the step
/// before knew nothing: there the step's own way counts in full.
///
/// Lines are kept by the foot P of the boxes' middle, so that a bit that slides along its axis does not move at all,
/// not even by rounding: F - F' is P - P' + (c - P) a (a - a'), but for what lies along a' and does not count.
class MoveCertificates {
 public:
  MoveCertificates() = default;
  /// Boxes around `centres_mm` (path-local) whose points lie within `half_mm` of them. No certificate holds yet.
  MoveCertificates(std::span<const Vec3> centres_mm, double half_mm,
                   const MoveKernels& kernels = move_kernels().back());

  std::size_t size() const { return free_.size(); }
  Vec3 centre_mm(std::size_t box) const { return middle_mm_ + Vec3(x_[box], y_[box], z_[box]); }
  double half_mm() const { return half_mm_; }

  /// The line that check() and renew() are for from here on.
  void move_to(const BitLine& line) noexcept;
  /// left_mm[n] = what is left of the certificate of box n in [begin, end); it holds where that is above 0.
  void check(std::size_t begin, std::size_t end, float* left_mm) const noexcept;
  /// The least of left_mm[n] of boxes in [begin, end), and the most that their certificates count of moves along the
  /// axis: what a certificate of all of them comes to.
  FreeMove together(std::size_t begin, std::size_t end, const float* left_mm) const noexcept;
  /// A certificate made at the line.
  void renew(std::size_t box, const FreeMove& free) noexcept;
  /// Box `to` becomes a copy of box `from`.
  void copy(std::size_t from, std::size_t to) noexcept;
  std::size_t memory_bytes() const { return 19 * size() * sizeof(float); }

 private:
  template <class Self, class Visit>
  static void for_each_column(Self& self, const Visit& visit);

  std::vector<float> x_, y_, z_;                 ///< centre, from middle_mm_
  std::vector<float> foot_x_, foot_y_, foot_z_;  ///< of the middle on the axis, from middle_mm_
  std::vector<float> turn_x_, turn_y_, turn_z_;  ///< axis less axis_
  std::vector<float> back_, free_, forward_, backward_;
  std::vector<float> side_x_, side_y_, side_z_, sine_, axial_, rest_;
  MoveLine line_{};
  Vec3 middle_mm_ = Vec3::Zero();
  Vec3 axis_ = Vec3::UnitZ();  ///< floats of differences from it are fine
  double max_mm_ = 0.0;        ///< of a centre's distance from the middle
  double half_mm_ = 0.0;
  const MoveKernels* kernels_ = &move_kernels().back();
};

}  // namespace spinaltap::detail
