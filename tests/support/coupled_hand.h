#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "core/base/random.h"
#include "core/session/coupling/virtual_coupling.h"
#include "core/session/device/loopback_device.h"
#include "tests/support/plane_bone.h"

namespace spinaltap::test {

/// What a seeded hand does with a seeded device.
enum class HandTask : std::uint8_t { moves_in_air, rests_on_bone, drills };

/// A device, a hand and a coupling by a seed. Ranges, log-uniform where they span decades: moving mass of the device
/// and of the hand 0.05 to 2 kg each, the device's damping 0.5 to 10 N s/m, half of them with dry friction to 0.2 N,
/// stiffness up to limits of 0.2 to 15 N/mm, forces to 3 to 40 N, delays to 5 ms in all, 1 or 2 kHz, 12 bits over 100
/// to 400 mm and over the force, two of three with up to 10 % of packets lost each way; half with turns and torque.
struct CoupledHand {
  explicit CoupledHand(std::uint64_t seed) : seed_(seed), task(static_cast<HandTask>(seed % 3)) {
    DeviceLimits& limits = loopback.limits;
    limits.rate_hz = uniform(0.0, 1.0) < 0.5 ? 1000.0 : 2000.0;
    limits.mass_kg = spread(0.05, 2.0);
    limits.damping_n_s_mm = spread(0.0005, 0.01);
    limits.friction_n = uniform(0.0, 1.0) < 0.5 ? 0.0 : uniform(0.0, 0.2);
    limits.max_stiffness_n_mm = spread(0.2, 15.0);
    limits.max_force_n = spread(3.0, 40.0);
    limits.position_step_mm = spread(100.0, 400.0) / 4096.0;
    const double delay_s = uniform(0.0, 0.005);
    const double there = uniform(0.0, 1.0), amplifier = uniform(0.0, 0.5);
    loopback.amplifier_s = std::min(0.001, amplifier * delay_s);
    loopback.pose_delay_s = there * (delay_s - loopback.amplifier_s);
    loopback.force_delay_s = delay_s - loopback.amplifier_s - loopback.pose_delay_s;
    loopback.force_step_n = 2.0 * limits.max_force_n / 4096.0;
    loopback.lost_share = uniform(0.0, 1.0) < 0.33 ? 0.0 : uniform(0.0, 0.1);
    loopback.seed = seed;
    if (uniform(0.0, 1.0) < 0.5) {
      limits.senses_turn = limits.gives_torque = true;
      limits.max_torque_n_mm = spread(50.0, 500.0);
      limits.max_stiffness_n_mm_rad = spread(500.0, 20'000.0);
      limits.inertia_kg_mm2 = spread(50.0, 2000.0);
      limits.damping_n_mm_s_rad = spread(0.5, 20.0);
      limits.angle_step_rad = 2.0 * std::numbers::pi / 4096.0;
    }
    coupling.stiffness_n_mm = uniform(0.0, 1.0) < 0.3 ? 0.0 : uniform(0.05, 1.0) * limits.max_stiffness_n_mm;
    LoopbackHand& hand = loopback.hand;
    hand.mass_kg = spread(0.05, 2.0);
    hand.stiffness_n_mm = task == HandTask::drills ? spread(0.02, 0.1) : spread(0.05, 1.0);
    const double mass = 1e-3 * (hand.mass_kg + limits.mass_kg);
    hand.damping_n_s_mm = uniform(0.3, 1.0) * 2.0 * std::sqrt(hand.stiffness_n_mm * mass);
    hand.inertia_kg_mm2 = spread(100.0, 3000.0);
    hand.stiffness_n_mm_rad = spread(500.0, 5000.0);
    hand.damping_n_mm_s_rad = uniform(0.3, 1.0) * 2.0 *
                              std::sqrt(hand.stiffness_n_mm_rad * 1e-3 * (hand.inertia_kg_mm2 + limits.inertia_kg_mm2));
    hu = uniform(150.0, 1400.0);
    bit = twist_drill(uniform(2.0, 4.0), 60.0, 118.0, 0.48);
    const double settles_s =
        7.0 / std::min(hand.damping_n_s_mm / (2.0 * mass), std::min(hand.stiffness_n_mm / hand.damping_n_s_mm, 100.0));
    set_task(settles_s);
  }

  /// What came of it.
  struct Outcome {
    double max_given_n_mm = 0.0;  ///< energy that the device gave beyond what the hand put in
    double still_n = 0.0;         ///< how far the force still goes to and fro at the end, from end to end
    double thrust_error = 0.0;    ///< of drilling: felt over the law's at the same feed, less 1
    double feed_mm_s = 0.0;
    double max_n = 0.0;
    double max_change = 0.0;  ///< of the force a cycle, over what is allowed
    double stiffness_n_mm = 0.0;
  };

  Outcome run() const {
    Outcome outcome;
    LoopbackDevice device(loopback);
    const DeviceLimits& limits = device.limits();
    const Spindle spindle;
    PlaneBone bone(bit, Material{}, task == HandTask::moves_in_air ? 500.0 : hu, spindle.rpm);
    CouplingOptions options = coupling;
    if (task == HandTask::drills) {
      // Ten times what the bone gives is all that a coupling takes.
      options.force_scale = std::min(10.0, push_n / bone.law().thrust_n(feed_mm_s / bone.turns_per_s()));
    }
    VirtualCoupling tool(limits, options, spindle, loopback.begin);
    outcome.stiffness_n_mm = tool.gains().way.stiffness;
    const double dt_s = 1.0 / limits.rate_hz;
    const auto cycles = static_cast<int>(end_s * limits.rate_hz);
    const auto last = static_cast<int>(0.3 * limits.rate_hz);
    ToolFeedback felt;
    Vec3 low = Vec3::Constant(1e9), high = Vec3::Constant(-1e9), before = Vec3::Zero();
    double thrust_n = 0.0, from_mm = 0.0, to_mm = 0.0;
    for (int cycle = 0; cycle < cycles; ++cycle) {
      DeviceSample sample;
      DeviceNews news;
      if (device.read(sample)) news.pose = sample.pose;
      news.buttons = loopback.hand.buttons;
      const ToolInput input = tool.step(news, felt, dt_s);
      const Vec3& given_n = input.device.force_n;
      device.give(given_n, input.device.torque_n_mm);
      felt = bone.step(input);
      outcome.max_given_n_mm = std::max(outcome.max_given_n_mm, -device.energy_in_n_mm());
      outcome.max_n = std::max(outcome.max_n, given_n.norm() / limits.max_force_n);
      const double allowed_n = limits.max_force_n * dt_s / options.whole_change_s;
      outcome.max_change = std::max(outcome.max_change, (given_n - before).norm() / allowed_n);
      before = given_n;
      if (cycle < cycles - last) continue;
      if (cycle == cycles - last) from_mm = input.pose.tip_mm.z();
      to_mm = input.pose.tip_mm.z();
      low = low.cwiseMin(device.acting_n());
      high = high.cwiseMax(device.acting_n());
      thrust_n -= device.acting_n().z() / last;
    }
    outcome.still_n = (high - low).maxCoeff();
    if (task == HandTask::drills) {
      outcome.feed_mm_s = (to_mm - from_mm) / ((last - 1) * dt_s);
      const double law_n = options.force_scale * bone.law().thrust_n(outcome.feed_mm_s / bone.turns_per_s());
      outcome.thrust_error = thrust_n / law_n - 1.0;
    }
    return outcome;
  }

 private:
  double uniform(double from, double to) { return from + (to - from) * random_uniform(seed_, index_++); }
  double spread(double from, double to) { return from * std::pow(to / from, random_uniform(seed_, index_++)); }

  void set_task(double settles_s) {
    LoopbackHand& hand = loopback.hand;
    const double max_n = loopback.limits.max_force_n;
    hand.swing_hz = uniform(0.5, 5.0);
    const double swing_mm = std::min(40.0, uniform(20.0, 200.0) / (2.0 * std::numbers::pi * hand.swing_hz));
    const Vec3 swing = Vec3(uniform(-1.0, 1.0), uniform(-1.0, 1.0), uniform(-1.0, 1.0)).normalized();
    if (loopback.limits.senses_turn) hand.swing_rad = uniform(0.0, 0.2) * swing.reverse();
    // No hand stretches a spring by more than 30 mm: a device that is so soft is pushed less.
    DeviceLimits limits = loopback.limits;
    limits.delay_s = loopback.pose_delay_s + loopback.force_delay_s + loopback.amplifier_s;
    const double stiffness_n_mm = coupling_gains(limits, coupling).way.stiffness;
    push_n = std::min(uniform(0.2, 0.8) * max_n, 30.0 * stiffness_n_mm);
    const double reach_mm = push_n / hand.stiffness_n_mm + push_n / stiffness_n_mm;
    feed_mm_s = uniform(0.3, 3.0);
    switch (task) {
      case HandTask::moves_in_air:
        loopback.begin.tip_mm.z() = -100.0;
        hand.swing_mm = swing_mm * swing;
        hand.swing_end_s = 0.8;
        break;
      case HandTask::rests_on_bone:
        // It taps while it comes, then leans.
        loopback.begin.tip_mm.z() = -3.0;
        hand.buttons = 0;
        hand.push_mm = 3.0 + reach_mm;
        hand.push_mm_s = hand.push_mm / uniform(0.2, 0.6);
        hand.swing_mm = 0.2 * swing_mm * Vec3::UnitZ();
        hand.swing_end_s = 0.8;
        break;
      case HandTask::drills:
        loopback.begin.tip_mm.z() = -1.0;
        hand.push_mm = 1.0 + reach_mm;
        hand.push_mm_s = hand.push_mm / 0.3;
        hand.swing_rad *= 0.1;
        hand.swing_end_s = 0.3;
        settles_s = 1.2;
        break;
    }
    end_s = 1.1 + std::clamp(settles_s, 0.3, 4.0);
  }

  std::uint64_t seed_;
  std::uint64_t index_ = 0;

 public:
  HandTask task;
  LoopbackOptions loopback;
  CouplingOptions coupling;
  DrillBit bit;
  double hu = 0.0;
  double push_n = 0.0;
  double feed_mm_s = 0.0;  ///< that the push leads to, by the law
  double end_s = 0.0;
};

}  // namespace spinaltap::test
