#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/unit/core/engine/askew_block.h"

namespace spinaltap::test {

/// A seeded operator that does all that operators do, a few steps each: forward, back, sideways, tilting about a point,
/// steps too small to see, leaving and entering elsewhere, jumps. It stays near the volume. Some begin on the path
/// exactly, where the bit's wall may lie on a ring; some begin nearly across it.
class AnyMotion {
 public:
  AnyMotion(std::uint64_t seed, double length_mm, double reach_mm)
      : draw_(seed), length_mm_(length_mm), reach_mm_(reach_mm) {
    const double kind = draw_(0.0, 1.0);
    if (kind < 0.3) {
      pose_ = {Vec3(0.0, 0.0, draw_(0.0, 0.6) * length_mm), Vec3::UnitZ()};
      return;
    }
    const double tilt_deg = kind < 0.8 ? draw_(0.0, 40.0) : draw_(60.0, 120.0);
    const double tilt = tilt_deg * std::numbers::pi / 180.0;
    const double lean = draw_(0.0, 2.0 * std::numbers::pi);
    pose_ = {inside(), Vec3(std::sin(tilt) * std::cos(lean), std::sin(tilt) * std::sin(lean), std::cos(tilt))};
  }

  /// Path-local.
  Pose next() {
    if (left_-- <= 0) begin_phase();
    if (is_jump_) {
      // Straight to there: along, across or both.
      pose_.tip_mm = inside();
      if (draw_(0.0, 1.0) < 0.1) turn(draw_(0.0, 0.1), pose_.tip_mm);
    } else {
      pose_.tip_mm += step_mm_ * direction_;
      if (turn_ != 0.0) turn(turn_, pivot_mm_);
    }
    return pose_;
  }

 private:
  Vec3 inside() {
    const double angle = draw_(0.0, 2.0 * std::numbers::pi);
    const double off_mm = draw_(0.0, 0.9) * reach_mm_;
    return {off_mm * std::cos(angle), off_mm * std::sin(angle), draw_(0.2, 1.1) * length_mm_};
  }

  void begin_phase() {
    left_ = static_cast<int>(draw_(3.0, 9.0));
    step_mm_ = std::pow(10.0, draw_(-3.0, -0.7));
    turn_ = 0.0;
    is_jump_ = pose_.tip_mm.z() < -1.0 || pose_.tip_mm.z() > 1.5 * length_mm_ ||
               pose_.tip_mm.head<2>().norm() > 1.5 * reach_mm_;
    if (is_jump_) {  // back from where nothing is
      left_ = 1;
      return;
    }
    const Vec3 across = draw_.direction().cross(pose_.axis).normalized();
    const double kind = draw_(0.0, 1.0);
    if (kind < 0.3) {
      direction_ = pose_.axis;
    } else if (kind < 0.4) {
      direction_ = -pose_.axis;
    } else if (kind < 0.55) {
      direction_ = across;
    } else if (kind < 0.75) {
      direction_ = draw_.direction();
      turns_about_ = across;
      turn_ = std::pow(10.0, draw_(-5.0, -2.0));
      pivot_mm_ = pose_.tip_mm - draw_(0.0, 4.0) * pose_.axis;
    } else if (kind < 0.82) {
      direction_ = draw_.direction();
      step_mm_ = 1e-7;
    } else if (kind < 0.9) {
      direction_ = -Vec3::UnitZ();  // out, in one step; the next phase enters elsewhere
      step_mm_ = length_mm_;
      left_ = 1;
    } else {
      is_jump_ = true;
      left_ = 2;
    }
  }

  void turn(double angle, const Vec3& pivot_mm) {
    if (turns_about_.isZero()) turns_about_ = any_perpendicular(pose_.axis);
    const Mat3 rotation = Eigen::AngleAxisd(angle, turns_about_).toRotationMatrix();
    pose_ = {pivot_mm + rotation * (pose_.tip_mm - pivot_mm), (rotation * pose_.axis).normalized()};
  }

  Draw draw_;
  double length_mm_, reach_mm_;
  Pose pose_;
  Vec3 direction_ = Vec3::UnitZ();
  Vec3 turns_about_ = Vec3::Zero();
  Vec3 pivot_mm_ = Vec3::Zero();
  double step_mm_ = 0.0, turn_ = 0.0;
  int left_ = 0;
  bool is_jump_ = false;
};

}  // namespace spinaltap::test
