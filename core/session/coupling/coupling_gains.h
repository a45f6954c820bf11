#pragma once

namespace spinaltap {

/// What a haptic device says of itself. A 3-DOF device neither senses nor gives turns.
struct DeviceLimits {
  double rate_hz = 1000.0;  ///< of poses and forces
  double delay_s = 0.0;     ///< from a pose to the force that answers it at the handle, beyond one period
  double max_force_n = 8.0;
  double max_stiffness_n_mm = 2.0;  ///< that its maker states
  double mass_kg = 0.2;             ///< that moves, at the handle
  double damping_n_s_mm = 0.002;    ///< of its own, at the handle: what makes a spring passive
  double friction_n = 0.0;          ///< dry, at the handle
  double position_step_mm = 0.0;    ///< of its encoders; 0: finer than matters
  bool senses_turn = false;         ///< its poses have an axis of their own
  bool gives_torque = false;        ///< and it answers turns
  double max_torque_n_mm = 0.0;     ///< the same things of turns
  double max_stiffness_n_mm_rad = 0.0;
  double inertia_kg_mm2 = 0.0;
  double damping_n_mm_s_rad = 0.0;
  double angle_step_rad = 0.0;
};
/// Rejects what is not finite or makes no sense.
void check_device_limits(const DeviceLimits& limits);

/// How a tool is coupled to a device. 0: chosen from the device's limits.
struct CouplingOptions {
  double stiffness_n_mm = 0.0;      ///< asked for, at the handle; it gets less where the device does not bear it
  double stiffness_n_mm_rad = 0.0;  ///< likewise
  /// What the device gives of what the bone gives: below 1 a weak device shows a strong bone. The tool cuts with no
  /// more than the device can show, over this.
  double force_scale = 1.0;
  double tool_mass_kg = 0.0;     ///< as it is felt at the handle
  double lost_s = 0.02;          ///< without a pose for so long the device is lost: the tool stands, and does not cut
  double fade_s = 0.05;          ///< within which its force then goes to zero
  double return_s = 0.25;        ///< within which it comes back when the device does
  double whole_change_s = 0.01;  ///< the least time for all of the largest force to come or go
  unsigned spindle_button = 0;   ///< this bit of the buttons turns the spindle on; 32: it is always on
};
/// Rejects what is not finite or makes no sense.
void check_coupling_options(const CouplingOptions& options);

/// One kind of motion of a coupled tool, as it is felt at the handle: along or about all axes alike. Units: of N and
/// mm, or of N·mm and rad.
struct CouplingGain {
  double stiffness = 0.0;     ///< of the spring between the device and the tool
  double damping = 0.0;       ///< of the damper beside it
  double mass = 0.0;          ///< of the tool: N s²/mm, N·mm s²
  double tool_damping = 0.0;  ///< of the tool by itself
};

/// The damping of its own that a device needs so that the spring, damper and tool of a gain are passive for any hand,
/// sampled every `dt_s` and `delay_s` late: Colgate & Schenkel (J. Robotic Systems 1997), b > T/2 / (1 - cos wT) Re((1
/// - exp(-jwT)) H), the largest over all frequencies up to half the rate, and over environments from none to a tool
/// that is held. H is that of the implicit Euler method, with which the tool moves.
double needed_damping(const CouplingGain& gain, double dt_s, double delay_s);

/// Of both kinds of motion: coupling_gains().
struct CouplingGains {
  CouplingGain way;   ///< N, mm
  CouplingGain turn;  ///< N·mm, rad
};
/// As stiff as the device bears: its maker's stiffness, needed_damping() within 0.7 of its own damping, and for a step
/// of its encoders no more force than 0.025 N, or than its friction holds (Diolaiti et al., IEEE Trans. Robotics 2006)
/// up to 0.045 N: less than a hand feels. Of a device that senses turns and gives no torque the spring that turns the
/// tool is as stiff as that of its ways at a lever of 30 mm. Throws Error as the checks do, and on a device without any
/// damping.
CouplingGains coupling_gains(const DeviceLimits& limits, const CouplingOptions& options);

}  // namespace spinaltap
