#include "apps/spinaltap-planner/navigation/desktop_device.h"

#include <Eigen/Geometry>

namespace spinaltap {
namespace {

constexpr double kKgToN = 1e-3;      // N s2/mm
constexpr double kHandKg = 0.2;      // of the hand, beside the device's own
constexpr double kHandNS_mm = 0.06;  // so that the handle comes to rest without swinging
constexpr double kTurnsS = 0.04;     // in which the handle follows a turn

}  // namespace

DesktopDevice::DesktopDevice() {
  limits_.max_stiffness_n_mm = 1.0;
  limits_.senses_turn = true;
}

void DesktopDevice::move(const Vec3& way_mm) {
  const std::lock_guard lock(mutex_);
  wants_.way_mm += way_mm;
}

void DesktopDevice::lean(const Eigen::Vector2d& turn_rad) {
  const std::lock_guard lock(mutex_);
  wants_.turn_rad += turn_rad;
}

void DesktopDevice::go(const Vec3& mm_s, const Eigen::Vector2d& rad_s) {
  const std::lock_guard lock(mutex_);
  wants_.mm_s = mm_s;
  wants_.rad_s = rad_s;
}

void DesktopDevice::press(std::uint32_t buttons) {
  const std::lock_guard lock(mutex_);
  wants_.buttons = buttons;
}

std::uint32_t DesktopDevice::buttons() const {
  const std::lock_guard lock(mutex_);
  return wants_.buttons;
}

bool DesktopDevice::read(DeviceSample& sample) noexcept {
  const double dt_s = 1.0 / limits_.rate_hz;
  heard_.way_mm.setZero();
  heard_.turn_rad.setZero();
  // Where the person is just telling something, it is heard a millisecond later.
  if (const std::unique_lock lock(mutex_, std::try_to_lock); lock) {
    heard_ = wants_;
    wants_.way_mm.setZero();
    wants_.turn_rad.setZero();
  }
  wanted_mm_ += heard_.way_mm + dt_s * heard_.mm_s;
  // A hand on a leash: beyond what the device can give, more way would only have to be taken back.
  const double leash_mm = limits_.max_force_n / kHandN_mm;
  const Vec3 lead_mm = wanted_mm_ - at_mm_;
  if (lead_mm.norm() > leash_mm) wanted_mm_ = at_mm_ + leash_mm * lead_mm.normalized();
  // The implicit Euler method, so that any rate is stable.
  const double mass = kKgToN * (limits_.mass_kg + kHandKg);
  mm_s_ = (mass * mm_s_ + dt_s * (kHandN_mm * (wanted_mm_ - at_mm_) + force_n_)) /
          (mass + dt_s * (kHandNS_mm + limits_.damping_n_s_mm) + dt_s * dt_s * kHandN_mm);
  at_mm_ += dt_s * mm_s_;
  wanted_rad_ += heard_.turn_rad + dt_s * heard_.rad_s;
  if (wanted_rad_.norm() > kMostLeanRad) wanted_rad_ *= kMostLeanRad / wanted_rad_.norm();
  leans_rad_ += dt_s / (kTurnsS + dt_s) * (wanted_rad_ - leans_rad_);

  // About x the axis leans up (-y), about y to the right.
  const Vec3 turn(-leans_rad_.y(), leans_rad_.x(), 0.0);
  const double angle = turn.norm();
  const Mat3 turned = angle > 0.0 ? Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix() : Mat3(Mat3::Identity());
  sample.pose = {at_mm_, turned.col(2), turned.col(0)};
  sample.buttons = heard_.buttons;
  sample.time_s = static_cast<double>(++reads_) * dt_s;
  return true;
}

bool DesktopDevice::give(const Vec3& force_n, const Vec3& /*torque_n_mm*/) noexcept {
  force_n_ = force_n;
  return true;
}

}  // namespace spinaltap
