#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/force/cutting_law.h"
#include "core/session/operator/operator.h"

namespace spinaltap::test {

/// Bone of one density below the plane z = 0, towards +z, as a tool's forces tell of it, worked out by hand: so cheap
/// that thousands of sessions run in a minute. It says of the last pose what a session says of it: thrust by the law,
/// a wall that is reamed away within a turn, contact with the spindle off.
class PlaneBone {
 public:
  PlaneBone(const DrillBit& bit, const Material& material, double hu, double rpm)
      : law_(resistance_of_block(bit, material, hu, rpm)),
        contact_n_mm_(material.contact_stiffness_n_mm(hu)),
        turns_per_s_(rpm / 60.0) {}

  const CuttingResistance& law() const { return law_; }
  double turns_per_s() const { return turns_per_s_; }
  double bottom_mm() const { return bottom_mm_; }

  ToolFeedback step(const ToolInput& input) {
    const Vec3 tip_mm = input.pose.tip_mm;
    const Vec3 moved_mm = is_placed_ ? Vec3(tip_mm - tip_mm_) : Vec3::Zero();
    const Vec3 turned = is_placed_ ? Vec3(input.pose.axis - axis_) : Vec3::Zero();
    is_placed_ = true;
    tip_mm_ = tip_mm;
    axis_ = input.pose.axis;
    const double newer = input.dt_s / (0.005 + input.dt_s);
    speed_mm_s_ += newer * (moved_mm / input.dt_s - speed_mm_s_);
    ToolFeedback felt;
    felt.time_s = time_s_ += input.dt_s;
    DrillForce& force = felt.force;
    if (!input.spindle_on) {
      pressed_mm_.setZero();
      pressed_turn_.setZero();
      const double into_mm = tip_mm.z() - bottom_mm_;
      if (!(into_mm > 0.0)) return felt;
      const double push_n = contact_n_mm_ * into_mm * std::max(0.0, 1.0 + 0.0015 * speed_mm_s_.z());
      force.contact_n = -push_n * Vec3::UnitZ();
      force.force_n = force.contact_n;
      force.contact.stiffness[14] = contact_n_mm_;
      return felt;
    }
    if (tip_mm.z() > bottom_mm_ - 0.02) {
      force.resistance = law_;
      force.thrust_n = law_.thrust_n(std::max(0.0, speed_mm_s_.dot(axis_)) / turns_per_s_);
    }
    bottom_mm_ = std::max(bottom_mm_, tip_mm.z());
    const double left = 1.0 / (1.0 + turns_per_s_ * input.dt_s);
    const auto across = [&](const Vec3& of) { return Vec3(of - of.dot(axis_) * axis_); };
    pressed_mm_ = left * across(pressed_mm_ + moved_mm);
    pressed_turn_ = left * across(pressed_turn_ + turned);
    // Rings of wall of 2 mm, each two thirds of a flat bit's section.
    const Vec3 u = any_perpendicular(axis_), v = axis_.cross(u);
    Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> hold(force.contact.stiffness.data());
    for (double back_mm = 2.0; back_mm < std::min(tip_mm.z(), 50.0); back_mm += 2.0) {
      const Vec3 from_tip_mm = -back_mm * axis_;
      const Vec3 aside_mm = pressed_mm_ - back_mm * pressed_turn_;
      for (const Vec3& direction : {u, v}) {
        const double stiff_n_mm = 2.0 / 3.0 * contact_n_mm_;
        const Vec3 push_n = -stiff_n_mm * aside_mm.dot(direction) * direction;
        force.support_n += push_n;
        force.contact.moment_n_mm += from_tip_mm.cross(push_n);
        Eigen::Matrix<double, 6, 1> lever;
        lever << direction, from_tip_mm.cross(direction);
        hold += stiff_n_mm * lever * lever.transpose();
      }
    }
    // The lips take some of their thrust sideways where they are moved there.
    const Vec3 aside_mm_s = across(speed_mm_s_);
    if (tip_mm.z() > 0.0 && aside_mm_s.norm() > 0.0) {
      force.lateral_n = -0.1 * law_.thrust_n(aside_mm_s.norm() / turns_per_s_) * aside_mm_s.normalized();
    }
    force.force_n = force.lateral_n + force.support_n - force.thrust_n * axis_;
    return felt;
  }

 private:
  CuttingResistance law_;
  double contact_n_mm_;
  double turns_per_s_;
  double bottom_mm_ = 0.0;
  double time_s_ = 0.0;
  bool is_placed_ = false;
  Vec3 tip_mm_ = Vec3::Zero(), axis_ = Vec3::UnitZ(), speed_mm_s_ = Vec3::Zero();
  Vec3 pressed_mm_ = Vec3::Zero(), pressed_turn_ = Vec3::Zero();
};

}  // namespace spinaltap::test
