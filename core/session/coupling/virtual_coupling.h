#pragma once

#include <optional>

#include "core/session/coupling/coupling_gains.h"
#include "core/session/coupling/energy_account.h"
#include "core/session/operator/operator.h"

namespace spinaltap {

/// What was heard of a device since the last cycle.
struct DeviceNews {
  std::optional<Pose> pose;   ///< patient LPS, unit axis; nothing: no news
  std::uint32_t buttons = 0;  ///< as they were last told
};

/// Share of the coupling's stiffness and damping that is left in air, where nothing is there that a spring could make
/// felt but the encoders' steps.
inline constexpr double kStiffInAir = 0.4;

/// A tool of its own mass that a device pulls by a spring and a damper, in six degrees of freedom (virtual coupling:
/// Colgate, Stanley & Brown 1995). Bone resists it: along its axis with the thrust that a feed asks
/// (CuttingResistance), sideways with the wall of its hole and what cutting takes, with the spindle off with contact.
/// The tool goes where all of these are in balance at the cycle's end, by the implicit Euler method, so that bone may
/// be as stiff as it likes; the device gets what the spring gives. docs/coupling.md.
///
/// The same news, feedback and times bring the same poses and forces.
class VirtualCoupling {
 public:
  /// `first`: where the device is, and the tool is put. Throws Error as coupling_gains() does.
  VirtualCoupling(const DeviceLimits& limits, const CouplingOptions& options, const Spindle& spindle,
                  const Pose& first);

  /// A cycle: what the session gets, with the device's side. `felt`: of the cycle before.
  ToolInput step(const DeviceNews& news, const ToolFeedback& felt, double dt_s) noexcept;

  const Pose& first() const { return first_; }
  const CouplingGains& gains() const { return gains_; }
  /// The device is lost, or its force is not all back.
  bool is_held() const { return hold_ < 1.0; }

 private:
  using Vec6 = Eigen::Matrix<double, 6, 1>;
  using Mat6 = Eigen::Matrix<double, 6, 6>;
  /// What moves the tool in a cycle: matrix · speed = push, but for the thrust.
  struct Balance;

  void hear(const DeviceNews& news, double dt_s) noexcept;
  void take_pose(const Pose& pose) noexcept;
  Vec3 axis() const { return turned_.col(2); }
  /// From the tool to the device, mm and rad.
  Twist stretch() const noexcept;
  void add_bone(const ToolFeedback& felt, bool spindle_on, double dt_s, Balance& balance) const noexcept;
  void move(const ToolFeedback& felt, bool spindle_on, double dt_s) noexcept;
  void give(double dt_s) noexcept;

  Pose first_;
  DeviceLimits limits_;
  CouplingOptions options_;
  Spindle spindle_;
  CouplingGains gains_;
  EnergyAccount energy_;

  DeviceSide device_;
  Mat3 device_turned_;  ///< columns: side, third, axis
  Twist device_rate_;   ///< a second
  double silent_s_ = 0.0;
  double hold_ = 1.0;    ///< share of the coupling that is there
  double stiff_ = 1.0;   ///< share of its stiffness and damping: less in air
  bool was_on_ = false;  ///< the spindle, in the cycle that was felt

  Vec3 tip_mm_;
  Mat3 turned_;
  Twist rate_;    ///< the tool's, a second
  Wrench pull_;   ///< of the coupling on the tool
  Wrench given_;  ///< to the device
};

}  // namespace spinaltap
