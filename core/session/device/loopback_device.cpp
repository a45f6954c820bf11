#include "core/session/device/loopback_device.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/error.h"
#include "core/base/random.h"

namespace spinaltap {
namespace {

constexpr double kKgToN = 1e-3;  // N s²/mm

Vec3 in_steps(const Vec3& value, double step) {
  if (!(step > 0.0)) return value;
  return {step * std::round(value.x() / step), step * std::round(value.y() / step),
          step * std::round(value.z() / step)};
}

/// Speed after a step under a push, with dry friction, which holds what is slow enough.
Vec3 with_friction(const Vec3& speed, double friction_over_mass) {
  const double is = speed.norm();
  if (!(is > friction_over_mass)) return Vec3::Zero();
  return speed * (1.0 - friction_over_mass / is);
}

LoopbackOptions checked_loopback(const LoopbackOptions& options) {
  constexpr double kLongestS = 0.1;
  for (const double delay_s : {options.pose_delay_s, options.force_delay_s, options.amplifier_s}) {
    if (!(delay_s >= 0.0 && delay_s <= kLongestS)) {
      fail("loopback device: expected delays from 0 to ", kLongestS, " s, found ", delay_s, " s");
    }
  }
  if (!(options.lost_share >= 0.0 && options.lost_share <= 1.0)) {
    fail("loopback device: expected a share of lost packets from 0 to 1, found ", options.lost_share);
  }
  if (!(options.force_step_n >= 0.0 && options.hand.mass_kg > 0.0 && options.hand.inertia_kg_mm2 > 0.0 &&
        options.hand.stiffness_n_mm >= 0.0 && options.hand.damping_n_s_mm >= 0.0)) {
    fail("loopback device: expected a hand with mass, and a stiffness and a damping of 0 or more");
  }
  return options;
}

}  // namespace

LoopbackDevice::LoopbackDevice(const LoopbackOptions& options)
    : options_(checked_loopback(options)),
      limits_(options.limits),
      tremor_(options.hand.tremor_mm, options.seed),
      step_s_(1.0 / (options.limits.rate_hz * kSteps)),
      at_mm_(options.begin.tip_mm) {
  limits_.delay_s = options.pose_delay_s + options.force_delay_s + options.amplifier_s;
  check_device_limits(limits_);
  const double longest_s = std::max(options.pose_delay_s, options.force_delay_s);
  past_.assign(static_cast<std::size_t>(std::ceil(longest_s / step_s_)) + 2, Moment{at_mm_});
}

double LoopbackDevice::chance() noexcept { return random_uniform(options_.seed, chances_++); }

double LoopbackDevice::stored_n_mm() const {
  return 0.5 * kKgToN *
         (limits_.mass_kg * speed_mm_s_.squaredNorm() + limits_.inertia_kg_mm2 * turns_rad_s_.squaredNorm());
}

void LoopbackDevice::advance() noexcept {
  const LoopbackHand& hand = options_.hand;
  const auto steps_of = [&](double s) { return static_cast<std::uint64_t>(std::llround(s / step_s_)); };
  const auto past = [&](std::uint64_t ago) -> const Moment& {
    return past_[(step_ + past_.size() - ago) % past_.size()];
  };
  const Moment& told = past(steps_of(options_.force_delay_s));
  const double nearer = step_s_ / (options_.amplifier_s + step_s_);
  acting_n_ += nearer * (told.force_n - acting_n_);
  acting_n_mm_ += nearer * (told.torque_n_mm - acting_n_mm_);

  time_s_ = static_cast<double>(step_ + 1) * step_s_;
  constexpr double kDiesS = 0.2;
  const double dies = std::clamp((hand.swing_end_s - time_s_) / kDiesS, 0.0, 1.0);
  const double swing = dies * dies * (3.0 - 2.0 * dies) * std::sin(2.0 * std::numbers::pi * hand.swing_hz * time_s_);
  const double pushed_mm = std::clamp(hand.push_mm_s * (time_s_ - hand.push_begin_s), 0.0, std::max(0.0, hand.push_mm));
  Vec3 wanted_mm = options_.begin.tip_mm + pushed_mm * hand.push + swing * hand.swing_mm;
  if (hand.tremor_mm > 0.0) wanted_mm += tremor_.at_mm(time_s_);

  const double mass = kKgToN * (limits_.mass_kg + hand.mass_kg);
  const double holds =
      mass + step_s_ * (limits_.damping_n_s_mm + hand.damping_n_s_mm) + step_s_ * step_s_ * hand.stiffness_n_mm;
  const Vec3 free_mm_s =
      (mass * speed_mm_s_ + step_s_ * (hand.stiffness_n_mm * (wanted_mm - at_mm_) + acting_n_)) / holds;
  speed_mm_s_ = with_friction(free_mm_s, step_s_ * limits_.friction_n / holds);
  at_mm_ += step_s_ * speed_mm_s_;
  const double mm_s = speed_mm_s_.norm();
  lost_n_mm_ += step_s_ * ((limits_.damping_n_s_mm * mm_s + limits_.friction_n) * mm_s - acting_n_.dot(speed_mm_s_));

  Vec3 turn = Vec3::Zero();
  if (limits_.senses_turn) {
    const Eigen::AngleAxisd is(turned_);
    turn = is.angle() * is.axis();
    const double inertia = kKgToN * (limits_.inertia_kg_mm2 + hand.inertia_kg_mm2);
    const double turns_hold = inertia + step_s_ * (limits_.damping_n_mm_s_rad + hand.damping_n_mm_s_rad) +
                              step_s_ * step_s_ * hand.stiffness_n_mm_rad;
    turns_rad_s_ = (inertia * turns_rad_s_ +
                    step_s_ * (hand.stiffness_n_mm_rad * (swing * hand.swing_rad - turn) + acting_n_mm_)) /
                   turns_hold;
    const double rad_s = turns_rad_s_.norm();
    if (rad_s > 0.0) {
      turned_ = (Eigen::AngleAxisd(rad_s * step_s_, turns_rad_s_ / rad_s).toRotationMatrix() * turned_).eval();
    }
    lost_n_mm_ += step_s_ * (limits_.damping_n_mm_s_rad * rad_s * rad_s - acting_n_mm_.dot(turns_rad_s_));
    const Eigen::AngleAxisd now(turned_);
    turn = now.angle() * now.axis();
  }
  ++step_;
  past_[step_ % past_.size()] = {at_mm_, turn, told_n_, told_n_mm_};
}

bool LoopbackDevice::read(DeviceSample& sample) noexcept {
  for (int n = 0; n < kSteps; ++n) advance();
  const bool is_silent = time_s_ >= options_.silent_from_s && time_s_ < options_.silent_to_s;
  if (chance() < options_.lost_share || is_silent) return false;
  const auto ago = static_cast<std::uint64_t>(std::llround(options_.pose_delay_s / step_s_));
  const Moment& seen = past_[(step_ + past_.size() - ago) % past_.size()];
  sample.pose = options_.begin;
  sample.pose.tip_mm = options_.begin.tip_mm + in_steps(seen.at_mm - options_.begin.tip_mm, limits_.position_step_mm);
  const Vec3 turn = in_steps(seen.turn, limits_.angle_step_rad);
  const double angle = turn.norm();
  if (angle > 0.0) {
    const Mat3 turned = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
    if (sample.pose.side == Vec3::Zero()) sample.pose.side = any_perpendicular(sample.pose.axis);
    sample.pose.axis = (turned * sample.pose.axis).normalized();
    sample.pose.side = turned * sample.pose.side;
  } else if (limits_.senses_turn && sample.pose.side == Vec3::Zero()) {
    sample.pose.side = any_perpendicular(sample.pose.axis);
  }
  sample.buttons = options_.hand.buttons | (time_s_ >= options_.hand.presses_from_s ? options_.hand.presses : 0U);
  sample.time_s = time_s_;
  return true;
}

bool LoopbackDevice::give(const Vec3& force_n, const Vec3& torque_n_mm) noexcept {
  const bool is_silent = time_s_ >= options_.silent_from_s && time_s_ < options_.silent_to_s;
  if (is_silent) return false;
  if (chance() < options_.lost_share) return true;
  told_n_ = in_steps(force_n, options_.force_step_n);
  if (limits_.gives_torque) told_n_mm_ = torque_n_mm;
  past_[step_ % past_.size()].force_n = told_n_;
  past_[step_ % past_.size()].torque_n_mm = told_n_mm_;
  return true;
}

}  // namespace spinaltap
