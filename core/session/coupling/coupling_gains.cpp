#include "core/session/coupling/coupling_gains.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "core/base/check_range.h"
#include "core/base/error.h"

namespace spinaltap {
namespace {

void check_coupled(double value, double lowest, double highest, const char* what) {
  check_range(value, lowest, highest, "coupling", what);
}

constexpr double kKg = 1e-3;  // in N s²/mm

/// What the tool is of one kind of motion, at a spring's stiffness.
CouplingGain gain_with(double stiffness, double mass, double damping) {
  constexpr double kDamped = 0.5;  // of critical: the implicit method adds to it
  return {stiffness, damping, mass, kDamped * 2.0 * std::sqrt(stiffness * mass)};
}

/// Of the damper beside the spring: the device's own bears no more, and where encoders step it must not knock.
double coupling_damping(double device_damping, double unfelt, double step, double dt_s) {
  constexpr double kShareOfOwn = 0.15;
  constexpr double kKnocks = 0.2;  // of what is not felt
  const double damping = kShareOfOwn * device_damping;
  return step > 0.0 ? std::min(damping, kKnocks * unfelt * dt_s / step) : damping;
}

/// The stiffest up to `max` whose needed damping the device has.
double passive_stiffness(double max, double mass, double damping, double device_damping, double dt_s, double delay_s) {
  constexpr double kOfItsOwn = 0.7;
  constexpr double kFiner = 0.97;
  constexpr int kSteps = 400;
  double stiffness = max;
  for (int n = 0; n < kSteps; ++n) {
    if (needed_damping(gain_with(stiffness, mass, damping), dt_s, delay_s) <= kOfItsOwn * device_damping) break;
    stiffness *= kFiner;
  }
  return stiffness;
}

}  // namespace

void check_device_limits(const DeviceLimits& limits) {
  check_coupled(limits.rate_hz, 100.0, 20'000.0, "a device's rate (Hz)");
  check_coupled(limits.delay_s, 0.0, 0.05, "a device's delay (s)");
  check_coupled(limits.max_force_n, 0.1, 1000.0, "a device's largest force (N)");
  check_coupled(limits.max_stiffness_n_mm, 1e-3, 1000.0, "a device's largest stiffness (N/mm)");
  check_coupled(limits.mass_kg, 1e-3, 100.0, "a device's mass (kg)");
  check_coupled(limits.damping_n_s_mm, 1e-6, 1.0, "a device's damping (N s/mm)");
  check_coupled(limits.friction_n, 0.0, 100.0, "a device's friction (N)");
  check_coupled(limits.position_step_mm, 0.0, 1.0, "a step of a device's position (mm)");
  if (!limits.senses_turn && limits.gives_torque) fail("coupling: expected a device that gives torque to sense turns");
  if (!limits.gives_torque) return;
  check_coupled(limits.max_torque_n_mm, 1.0, 1e5, "a device's largest torque (N mm)");
  check_coupled(limits.max_stiffness_n_mm_rad, 1.0, 1e7, "a device's largest stiffness (N mm/rad)");
  check_coupled(limits.inertia_kg_mm2, 1e-2, 1e6, "a device's inertia (kg mm2)");
  check_coupled(limits.damping_n_mm_s_rad, 1e-4, 1e5, "a device's damping of turns (N mm s/rad)");
  check_coupled(limits.angle_step_rad, 0.0, 0.1, "a step of a device's angle (rad)");
}

void check_coupling_options(const CouplingOptions& options) {
  check_coupled(options.stiffness_n_mm, 0.0, 1000.0, "a stiffness (N/mm)");
  check_coupled(options.stiffness_n_mm_rad, 0.0, 1e7, "a stiffness (N mm/rad)");
  check_coupled(options.force_scale, 1e-3, 10.0, "a scale of forces");
  check_coupled(options.tool_mass_kg, 0.0, 10.0, "a tool's mass (kg)");
  check_coupled(options.lost_s, 1e-3, 1.0, "a time without poses (s)");
  check_coupled(options.fade_s, 1e-3, 1.0, "a time to fade (s)");
  check_coupled(options.return_s, 1e-3, 10.0, "a time to come back (s)");
  check_coupled(options.whole_change_s, 1e-3, 1.0, "a time of change (s)");
  if (options.spindle_button > 32) {
    fail("coupling: expected a button of the spindle from 0 to 31, or 32, found ", options.spindle_button);
  }
}

double needed_damping(const CouplingGain& gain, double dt_s, double delay_s) {
  using Complex = std::complex<double>;
  constexpr int kFrequencies = 160;
  constexpr double kSlowest = 2.0 * std::numbers::pi * 0.2;
  const double fastest = std::numbers::pi / dt_s;
  double most = 0.0;
  for (int n = 0; n < kFrequencies; ++n) {
    const double w = kSlowest * std::pow(fastest / kSlowest, static_cast<double>(n) / (kFrequencies - 1));
    const Complex back = 1.0 - std::exp(Complex(0.0, -w * dt_s));  // a difference between cycles
    const Complex rate = back / dt_s;
    const Complex coupling = gain.stiffness + gain.damping * rate;
    const Complex tool = gain.mass * rate * rate + gain.tool_damping * rate;
    const Complex late = std::exp(Complex(0.0, -w * delay_s));
    const double factor = 0.5 * dt_s / (1.0 - std::cos(w * dt_s));
    for (const double bone : {0.0, 0.25, 1.0, 4.0, 1e6}) {
      const Complex held = tool + bone * gain.stiffness;
      const Complex felt = coupling * held / (coupling + held);
      most = std::max(most, factor * (back * felt * late).real());
    }
  }
  return most;
}

CouplingGains coupling_gains(const DeviceLimits& limits, const CouplingOptions& options) {
  constexpr double kLeverMm = 30.0;
  constexpr double kUnfeltN = 0.025;
  constexpr double kMostN = 0.045;
  constexpr double kUnfeltNMm = 1.0;
  constexpr double kShareOfMass = 0.1;
  check_device_limits(limits);
  check_coupling_options(options);
  const double dt_s = 1.0 / limits.rate_hz;
  const double mass =
      kKg * (options.tool_mass_kg > 0.0 ? options.tool_mass_kg : std::clamp(kShareOfMass * limits.mass_kg, 0.005, 0.1));
  double most_n_mm = limits.max_stiffness_n_mm;
  if (options.stiffness_n_mm > 0.0) most_n_mm = std::min(most_n_mm, options.stiffness_n_mm);
  if (limits.position_step_mm > 0.0) {
    most_n_mm = std::min(most_n_mm, std::clamp(2.0 * limits.friction_n, kUnfeltN, kMostN) / limits.position_step_mm);
  }
  CouplingGains gains;
  const double damping = coupling_damping(limits.damping_n_s_mm, kUnfeltN, limits.position_step_mm, dt_s);
  gains.way = gain_with(passive_stiffness(most_n_mm, mass, damping, limits.damping_n_s_mm, dt_s, limits.delay_s), mass,
                        damping);
  if (!limits.gives_torque) {
    const double lever2 = kLeverMm * kLeverMm;
    gains.turn = gain_with(lever2 * gains.way.stiffness, lever2 * mass, 0.0);
    return gains;
  }
  const double inertia = kKg * kShareOfMass * limits.inertia_kg_mm2;
  double most_n_mm_rad = limits.max_stiffness_n_mm_rad;
  if (options.stiffness_n_mm_rad > 0.0) most_n_mm_rad = std::min(most_n_mm_rad, options.stiffness_n_mm_rad);
  if (limits.angle_step_rad > 0.0) most_n_mm_rad = std::min(most_n_mm_rad, kUnfeltNMm / limits.angle_step_rad);
  const double turns = coupling_damping(limits.damping_n_mm_s_rad, kUnfeltNMm, limits.angle_step_rad, dt_s);
  gains.turn =
      gain_with(passive_stiffness(most_n_mm_rad, inertia, turns, limits.damping_n_mm_s_rad, dt_s, limits.delay_s),
                inertia, turns);
  return gains;
}

}  // namespace spinaltap
