#pragma once

#include "core/base/geometry.h"

namespace spinaltap {

/// Forces for a haptic device that asks more often than cycles end: extrapolates the last two, within bounds.
///
/// Between cycles the force goes on along its last change, for one cycle at most, is never longer than the longer of
/// the last two, and never turns against the last one. A cycle without force counts at once: losing contact does not
/// overshoot.
class ForceOutput {
 public:
  /// A cycle's force (N) at its time (s). Times must rise; others start anew.
  void update(const Vec3& force_n, double time_s) noexcept;
  /// The force at a later time, N.
  Vec3 at(double time_s) const noexcept;

 private:
  Vec3 last_n_ = Vec3::Zero(), before_n_ = Vec3::Zero();
  double last_s_ = 0.0, before_s_ = 0.0;
  int count_ = 0;
};

}  // namespace spinaltap
