#pragma once

#include <vector>

#include "core/base/geometry.h"
#include "core/session/coupling/coupling_gains.h"

namespace spinaltap {

/// What a device gives: N, and N·mm about the tip.
struct Wrench {
  Vec3 force_n = Vec3::Zero();
  Vec3 torque_n_mm = Vec3::Zero();
};
/// How a device's handle goes: mm and rad, or those a second.
struct Twist {
  Vec3 way = Vec3::Zero();
  Vec3 turn = Vec3::Zero();
};

/// The energy that a hand has put into a coupling and not got back: passivity in the time domain, by an observer and a
/// controller (Hannaford & Ryu, IEEE Trans. Robotics and Automation 2002). Changed here:
///
/// - The observer pairs each way of the handle with the force that acted on it then, which was told a delay before, and
///   not with the latest (Stramigioli et al., IEEE Trans. Robotics 2005: with a held force, exact whatever the rate).
/// - The controller opens a valve rather than adding damping in proportion: a force that moves with the hand may give
/// no
///   more power than the account holds, over a time some delays long. The account thus runs empty without a jump, and
///   what is still under way cannot overdraw it. Damping is added only below zero, up to half of the device's own.
/// - The account holds no more than the coupling's spring can store: what was drilled away long ago is no credit.
class EnergyAccount {
 public:
  EnergyAccount(const DeviceLimits& limits, const CouplingGains& gains, double dt_s);

  /// The handle went so far since it was last heard of.
  void moved(const Twist& way) noexcept;
  /// What of `wanted` may be given now, the handle going at `rate`.
  Wrench allowed(const Wrench& wanted, const Twist& rate) const noexcept;
  /// What is given from now on, for `dt_s`.
  void given(const Wrench& wrench, double dt_s) noexcept;

  /// N·mm, which are mJ.
  double left_n_mm() const { return left_n_mm_; }

 private:
  DeviceLimits limits_;
  double dt_s_;
  double most_n_mm_;
  double empties_s_;
  std::vector<Wrench> under_way_;  ///< told, and not yet acting; a ring
  std::size_t next_ = 0;
  Wrench acted_;  ///< times the time, since the handle was last heard of
  double acted_s_ = 0.0;
  Twist smooth_rate_;  ///< free of the encoders' steps
  double left_n_mm_ = 0.0;
};

}  // namespace spinaltap
