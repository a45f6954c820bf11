#include "core/session/coupling/energy_account.h"

#include <algorithm>
#include <cmath>

namespace spinaltap {
namespace {

constexpr double kSmoothS = 0.01;

/// What a speed surely is at least, given how encoders step.
double sure_speed(double seen, double step) { return std::max(0.0, seen - step / kSmoothS); }

}  // namespace

EnergyAccount::EnergyAccount(const DeviceLimits& limits, const CouplingGains& gains, double dt_s)
    : limits_(limits),
      dt_s_(dt_s),
      empties_s_(std::max(0.006, 4.0 * (limits.delay_s + 2.0 * dt_s))),
      under_way_(static_cast<std::size_t>(std::lround(limits.delay_s / dt_s)) + 1) {
  constexpr double kSpareNMm = 0.2;
  most_n_mm_ = kSpareNMm + 0.5 * limits.max_force_n * limits.max_force_n / gains.way.stiffness;
  if (limits.gives_torque) most_n_mm_ += 0.5 * limits.max_torque_n_mm * limits.max_torque_n_mm / gains.turn.stiffness;
}

void EnergyAccount::moved(const Twist& way) noexcept {
  constexpr double kOfItsOwn = 0.5;  // a device's damping is not known better
  if (!(acted_s_ > 0.0)) return;
  const double dt_s = acted_s_;
  const double newer = dt_s / (kSmoothS + dt_s);
  smooth_rate_.way += newer * (way.way / dt_s - smooth_rate_.way);
  smooth_rate_.turn += newer * (way.turn / dt_s - smooth_rate_.turn);
  const double mm_s = sure_speed(smooth_rate_.way.norm(), limits_.position_step_mm);
  double lost_w = (limits_.damping_n_s_mm * mm_s + limits_.friction_n) * mm_s;
  double gives_n_mm = acted_.force_n.dot(way.way) / dt_s;
  if (limits_.gives_torque) {
    const double rad_s = sure_speed(smooth_rate_.turn.norm(), limits_.angle_step_rad);
    lost_w += limits_.damping_n_mm_s_rad * rad_s * rad_s;
    gives_n_mm += acted_.torque_n_mm.dot(way.turn) / dt_s;
  }
  left_n_mm_ = std::min(most_n_mm_, left_n_mm_ + kOfItsOwn * lost_w * dt_s - gives_n_mm);
  acted_ = {};
  acted_s_ = 0.0;
}

Wrench EnergyAccount::allowed(const Wrench& wanted, const Twist& rate) const noexcept {
  constexpr double kAdded = 0.5;  // of the device's own damping
  Wrench allowed = wanted;
  // Steps of the encoders are no speed of a handle that rests: the valve would make it knock.
  const auto surely_goes = [&](const Vec3& now, const Vec3& smooth, double step) {
    return now.norm() > 1.75 * step / dt_s_ || sure_speed(smooth.norm(), step) > 0.0;
  };
  const bool goes = surely_goes(rate.way, smooth_rate_.way, limits_.position_step_mm);
  const bool turns = limits_.gives_torque && surely_goes(rate.turn, smooth_rate_.turn, limits_.angle_step_rad);
  const double by_way = goes ? std::max(0.0, wanted.force_n.dot(rate.way)) : 0.0;
  const double by_turn = turns ? std::max(0.0, wanted.torque_n_mm.dot(rate.turn)) : 0.0;
  const double may_give = std::max(0.0, left_n_mm_) / empties_s_;
  if (by_way + by_turn > may_give) {
    const double too_much = 1.0 - may_give / (by_way + by_turn);
    if (by_way > 0.0) allowed.force_n -= too_much * by_way / rate.way.squaredNorm() * rate.way;
    if (by_turn > 0.0) allowed.torque_n_mm -= too_much * by_turn / rate.turn.squaredNorm() * rate.turn;
  }
  if (left_n_mm_ < 0.0) {
    const double mm_s = sure_speed(smooth_rate_.way.norm(), limits_.position_step_mm);
    if (mm_s > 0.0) {
      const double wanted_n_s_mm = -left_n_mm_ / (empties_s_ * mm_s * mm_s);
      allowed.force_n -= std::min(kAdded * limits_.damping_n_s_mm, wanted_n_s_mm) * smooth_rate_.way;
    }
  }
  return allowed;
}

void EnergyAccount::given(const Wrench& wrench, double dt_s) noexcept {
  under_way_[next_] = wrench;
  next_ = (next_ + 1) % under_way_.size();
  const Wrench& acts = under_way_[next_];
  acted_.force_n += dt_s * acts.force_n;
  acted_.torque_n_mm += dt_s * acts.torque_n_mm;
  acted_s_ += dt_s;
}

}  // namespace spinaltap
