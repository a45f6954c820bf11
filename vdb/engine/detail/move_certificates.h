#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/base/geometry.h"

namespace spinaltap::detail {

/// How far a bit may move before it can touch the points of a box.
struct FreeMove {
  double free_mm = -1.0;  ///< none where not above 0
  double forward = 0.0;   ///< how much of the bit's advance along its axis counts
  double backward = 0.0;  ///< and of its retreat
};

/// A bit's axis at the end of a step, as certificates are checked against it.
struct BitLine {
  Vec3 tip_mm = Vec3::Zero();  ///< path-local
  Vec3 axis = Vec3::UnitZ();   ///< unit, from the base to the tip
  double turned = 0.0;         ///< |difference of the axes| over the step
  double edge_mm = 0.0;        ///< of the step, see SweptBit
};

/// For each of many boxes of one size, how far the bit may move before it can touch a living point there.
///
/// A box's certificate was made at some line of the axis, a' where it is a now. For every point p within h of the box's
/// centre c, whose foot on the axis is F, the vector from the axis to p changes across the old axis by at most
///   |F - F'| + |a - a'| |p - F|,   |p - F| <= h + |c - F|,
/// and p's place along the axis by at most that of c and h |a - a'|. A step's chord (see SweptBit) between two ends
/// parts from both by no more than the step's own turn times |p - F|. So the certificate holds while
///   |F - F'| + ((|a - a'| + turned) (h + |c - F|) + edge) (1 + forward) + what counts of the way along  <  free.
/// All terms but the turn are convex along a step: what holds at both ends holds between.
///
/// Lines are kept by the foot P of the boxes' middle, so that a bit that slides along its axis does not move at all,
/// not even by rounding: F - F' is P - P' + (c - P) a (a - a'), but for what lies along a' and does not count.
class MoveCertificates {
 public:
  MoveCertificates() = default;
  /// Boxes around `centres_mm` (path-local) whose points lie within `half_mm` of them. No certificate holds yet.
  MoveCertificates(std::span<const Vec3> centres_mm, double half_mm);

  std::size_t size() const { return free_.size(); }
  Vec3 centre_mm(std::size_t box) const { return middle_mm_ + Vec3(x_[box], y_[box], z_[box]); }
  double half_mm() const { return half_mm_; }
  double forward(std::size_t box) const { return static_cast<double>(forward_[box]); }
  double backward(std::size_t box) const { return static_cast<double>(backward_[box]); }

  /// left_mm[n] = what is left of the certificate of box n in [begin, end); it holds where that is above 0.
  void check(const BitLine& line, std::size_t begin, std::size_t end, float* left_mm) const noexcept;
  /// A certificate made at `line`.
  void renew(std::size_t box, const BitLine& line, const FreeMove& free) noexcept;
  /// Box `to` becomes a copy of box `from`.
  void copy(std::size_t from, std::size_t to) noexcept;
  std::size_t memory_bytes() const { return 13 * size() * sizeof(float); }

 private:
  struct Line;
  Line relative(const BitLine& line) const noexcept;
  template <class Self, class Visit>
  static void for_each_column(Self& self, const Visit& visit);

  std::vector<float> x_, y_, z_;                 ///< centre, from middle_mm_
  std::vector<float> foot_x_, foot_y_, foot_z_;  ///< of the middle on the axis, from middle_mm_
  std::vector<float> turn_x_, turn_y_, turn_z_;  ///< axis less axis_
  std::vector<float> back_, free_, forward_, backward_;
  Vec3 middle_mm_ = Vec3::Zero();
  Vec3 axis_ = Vec3::UnitZ();  ///< floats of differences from it are fine
  double max_mm_ = 0.0;        ///< of a centre's distance from the middle
  double half_mm_ = 0.0;
};

}  // namespace spinaltap::detail
