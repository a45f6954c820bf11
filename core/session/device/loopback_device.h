#pragma once

#include <vector>

#include "core/session/device/haptic_device.h"
#include "core/session/operator/path_motion.h"

namespace spinaltap {

/// A simulated hand: a mass that a spring and a damper pull towards where its owner wants it.
struct LoopbackHand {
  double mass_kg = 0.5;
  double stiffness_n_mm = 0.5;
  double damping_n_s_mm = 0.005;
  double stiffness_n_mm_rad = 2000.0;  ///< of turns
  double damping_n_mm_s_rad = 20.0;
  double inertia_kg_mm2 = 500.0;

  /// Where it wants to be, from where it begins: along `push`, evenly, up to `push_mm`; and to and fro along `swing_mm`
  /// (and about `swing_rad`), which dies down before `swing_end_s`.
  Vec3 push = Vec3::UnitZ();
  double push_begin_s = 0.0;
  double push_mm_s = 0.0;
  double push_mm = 0.0;
  Vec3 swing_mm = Vec3::Zero();
  Vec3 swing_rad = Vec3::Zero();
  double swing_hz = 1.0;
  double swing_end_s = 1e9;
  double tremor_mm = 0.0;  ///< Tremor's amplitude
  std::uint32_t buttons = 1;
  double presses_from_s = 1e9;  ///< from then on it holds these as well
  std::uint32_t presses = 0;
};

struct LoopbackOptions {
  DeviceLimits limits = {};    ///< what it is, and says of itself; delay_s is made of the three times below
  Pose begin = {};             ///< in its own coordinates
  double pose_delay_s = 0.0;   ///< from the handle to who reads
  double force_delay_s = 0.0;  ///< from who gives to the amplifier
  double amplifier_s = 0.0;    ///< its time constant
  double force_step_n = 0.0;   ///< of its converter; 0: fine
  double lost_share = 0.0;     ///< of packets, each way
  double silent_from_s = 1e9;  ///< nothing comes or goes meanwhile: a cable that is pulled
  double silent_to_s = 1e9;
  LoopbackHand hand = {};
  std::uint64_t seed = 1;
};

/// A device that is not there: an arm with mass, damping, dry friction, encoders, delays, an amplifier and a converter,
/// and a hand that holds it. Its time goes on by one period with each read(): as fast as it is asked. The same options
/// and forces bring the same samples.
class LoopbackDevice final : public HapticDevice {
 public:
  /// Throws Error on limits that make no sense, and delays over 0.1 s.
  explicit LoopbackDevice(const LoopbackOptions& options);

  const std::string& name() const override { return name_; }
  const DeviceLimits& limits() const override { return limits_; }
  bool read(DeviceSample& sample) noexcept override;
  bool give(const Vec3& force_n, const Vec3& torque_n_mm) noexcept override;

  double time_s() const { return time_s_; }
  /// Where the handle really is and how it goes, in its own coordinates.
  const Vec3& place_mm() const { return at_mm_; }
  const Vec3& speed_mm_s() const { return speed_mm_s_; }
  /// What the amplifier really gives, N.
  const Vec3& acting_n() const { return acting_n_; }
  /// What the hand has put into the device at the handle, less what it got back, N·mm (mJ).
  double energy_in_n_mm() const { return lost_n_mm_ + stored_n_mm(); }

 private:
  static constexpr int kSteps = 10;  ///< of the arm in a period

  double stored_n_mm() const;
  void advance() noexcept;
  double chance() noexcept;

  LoopbackOptions options_;
  DeviceLimits limits_;
  std::string name_ = "loopback";
  Tremor tremor_;
  double step_s_;
  double time_s_ = 0.0;
  std::uint64_t step_ = 0;
  std::uint64_t chances_ = 0;

  Vec3 at_mm_, speed_mm_s_ = Vec3::Zero();
  Mat3 turned_ = Mat3::Identity();  ///< since it began
  Vec3 turns_rad_s_ = Vec3::Zero();
  Vec3 acting_n_ = Vec3::Zero(), acting_n_mm_ = Vec3::Zero();
  Vec3 told_n_ = Vec3::Zero(), told_n_mm_ = Vec3::Zero();  ///< last, and not lost
  double lost_n_mm_ = 0.0;                                 ///< energy that did not stay in the arm

  struct Moment {
    Vec3 at_mm = Vec3::Zero();
    Vec3 turn = Vec3::Zero();
    Vec3 force_n = Vec3::Zero();
    Vec3 torque_n_mm = Vec3::Zero();
  };
  std::vector<Moment> past_;  ///< by step: poses seen, and forces told
};

}  // namespace spinaltap
