#pragma once

#include <optional>

#include "core/session/coupling/virtual_coupling.h"
#include "core/session/device/haptic_device.h"
#include "core/session/operator/operator.h"
#include "core/tool/drill_path.h"

namespace spinaltap {

/// How a device's coordinates lie in the patient: a place and a turn, no scale.
struct DeviceMount {
  Mat3 turn = Mat3::Identity();  ///< patient = turn · device + place
  Vec3 place_mm = Vec3::Zero();

  /// So that the device's pose is that of the patient: place to place, axis to axis and, where both have one, side to
  /// side.
  static DeviceMount between(const Pose& device, const Pose& patient);

  /// A device's pose as one of the patient.
  Pose to_patient(const Pose& device) const;
  Vec3 to_device(const Vec3& patient) const;  ///< a force or a torque
};

/// How a hand at a device holds the tool, and when it is at an end.
struct CoupledOptions {
  CouplingOptions coupling = {};
  Spindle spindle = {};                   ///< as the session has it
  std::optional<DeviceMount> mount = {};  ///< none: the device's first pose is the begin of the path's lead-in
  double lead_in_mm = 3.0;                ///< how far before the entry that is
  double longest_s = 600.0;               ///< ends then, in session time
  double gives_up_s = 10.0;               ///< ends where the device is lost for so long
  unsigned end_button = 32;               ///< this button ends it; 32: none does
};

/// An operator that is a hand at a device: its tool is coupled to it (VirtualCoupling). In lock-step with the device's
/// own rate; SessionOptions::has_device is to be on, so that it feels how bone holds the tool.
class CoupledOperator final : public Operator {
 public:
  /// `device` must outlive this. Throws Error on options and limits that make no sense.
  CoupledOperator(HapticDevice& device, const DrillPath& path, const CoupledOptions& options);
  /// Asks the device for no force, so that it is not left with one.
  ~CoupledOperator() override;

  /// The first call waits for the device's first pose, for 2 s at most: then it throws Error.
  std::optional<ToolInput> next(const ToolFeedback& feedback) override;
  OperatorEnd end() const override { return end_; }

  /// Nothing before the device's first pose.
  const VirtualCoupling* coupling() const { return coupling_ ? &*coupling_ : nullptr; }
  std::uint64_t silent_cycles() const { return silent_cycles_; }  ///< without a new pose

 private:
  std::optional<Pose> hear() noexcept;
  void begin();

  HapticDevice& device_;
  DrillPath path_;
  CoupledOptions options_;
  double dt_s_;
  std::optional<DeviceMount> mount_;
  std::optional<VirtualCoupling> coupling_;
  std::uint32_t buttons_ = 0;
  double last_sample_s_;
  std::uint64_t cycles_ = 0;
  std::uint64_t silent_cycles_ = 0;
  std::uint64_t rejected_poses_ = 0;
  double lost_s_ = 0.0;
  OperatorEnd end_ = OperatorEnd::as_planned;
};

}  // namespace spinaltap
