#pragma once

#include <cstdint>
#include <mutex>
#include <string>

#include "core/session/device/haptic_device.h"

namespace spinaltap {

/// A device for those who have none: keyboard and mouse say where a hand wants a handle, and a spring pulls it there.
/// The handle has mass and damping, and the bone's force holds it back: how far hand and handle are apart is how hard
/// the hand leans. Its own coordinates: x to the right and y down as somebody sees it who looks along z, which is the
/// bit's way forwards; the tip is at 0 when it begins. It goes by one period with each read().
///
/// The person's side may be told and asked from another thread.
class DesktopDevice final : public HapticDevice {
 public:
  DesktopDevice();

  const std::string& name() const override { return name_; }
  const DeviceLimits& limits() const override { return limits_; }
  bool read(DeviceSample& sample) noexcept override;
  bool give(const Vec3& force_n, const Vec3& torque_n_mm) noexcept override;

  /// The hand wants to be so much further.
  void move(const Vec3& way_mm);
  /// And to lean the handle over by so much more: its axis to the right and down.
  void lean(const Eigen::Vector2d& turn_rad);
  /// What it goes on to do until it is told otherwise: while keys are held.
  void go(const Vec3& mm_s, const Eigen::Vector2d& rad_s);
  void press(std::uint32_t buttons);
  std::uint32_t buttons() const;

  static constexpr double kHandN_mm = 2.0;
  static constexpr double kMostLeanRad = 0.8;

 private:
  struct Wants {
    Vec3 way_mm = Vec3::Zero();  ///< since it was last asked
    Eigen::Vector2d turn_rad = Eigen::Vector2d::Zero();
    Vec3 mm_s = Vec3::Zero();
    Eigen::Vector2d rad_s = Eigen::Vector2d::Zero();
    std::uint32_t buttons = 0;
  };

  std::string name_ = "keyboard and mouse";
  DeviceLimits limits_;
  mutable std::mutex mutex_;
  Wants wants_;  ///< the person's, under the mutex

  // read()'s and give()'s thread alone
  Wants heard_;
  Vec3 wanted_mm_ = Vec3::Zero(), at_mm_ = Vec3::Zero(), mm_s_ = Vec3::Zero();
  Eigen::Vector2d wanted_rad_ = Eigen::Vector2d::Zero(), leans_rad_ = Eigen::Vector2d::Zero();
  Vec3 force_n_ = Vec3::Zero();
  std::uint64_t reads_ = 0;
};

}  // namespace spinaltap
