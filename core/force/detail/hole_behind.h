#pragma once

#include <algorithm>

#include "core/base/geometry.h"
#include "core/force/cutting_law.h"

namespace spinaltap {

/// The hole that a bit has cut for itself along its axis, as margins and flutes meet it. Positions: patient LPS, mm.
class HoleBehind {
 public:
  void reset() noexcept { *this = HoleBehind(); }
  /// After an advance of `fresh_mm` that took `energy_n_mm` at the reference feed. Further aside than the hole is wide
  /// begins another.
  void take(double fresh_mm, double energy_n_mm, const Vec3& tip_mm, const Vec3& axis, double radius_mm) noexcept {
    const Vec3 from_mm = tip_mm - entry_mm_;
    const bool is_elsewhere = (from_mm - from_mm.dot(axis) * axis).norm() > radius_mm;
    if (!is_begun_ || is_elsewhere) {
      reset();
      if (!(energy_n_mm > 0.0)) return;
      is_begun_ = true;
      entry_mm_ = tip_mm - fresh_mm * axis;
    }
    length_mm_ += fresh_mm;
    energy_n_mm_ += energy_n_mm;
  }
  /// What of it a bit of that section stands in.
  DrilledDepth behind(const Vec3& tip_mm, const Vec3& axis, double section_mm2) const noexcept {
    if (!(length_mm_ > 0.0)) return {};
    return {std::clamp((tip_mm - entry_mm_).dot(axis), 0.0, length_mm_), energy_n_mm_ / (section_mm2 * length_mm_)};
  }

 private:
  bool is_begun_ = false;
  Vec3 entry_mm_ = Vec3::Zero();
  double length_mm_ = 0.0;
  double energy_n_mm_ = 0.0;
};

}  // namespace spinaltap
