#include "core/session/compliant_tool.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/check_range.h"

namespace spinaltap {

void check_compliance(const ComplianceOptions& options) {
  const auto within = [](double value, double lowest, double highest, const char* what) {
    check_range(value, lowest, highest, "compliance", what);
  };
  within(options.free_length_mm, 0.0, 1000.0, "a free length (mm)");
  within(options.young_gpa, 1.0, 1000.0, "a modulus (GPa)");
  within(options.flutes_share, 0.01, 1.0, "a share of a full cylinder");
  within(options.friction, 0.0, 10.0, "a coefficient of friction");
  within(options.bite_mm, 0.0, 10.0, "a bite (mm)");
  within(options.stall_n_mm, 0.0, 1e6, "a torque of stall (N mm)");
  within(options.spin_up_s, 1e-4, 10.0, "a time to spin up (s)");
}

CompliantTool::CompliantTool(const DrillBit& bit, const ComplianceOptions& options) : options_(options) {
  check_bit(bit);
  check_compliance(options);
  length_mm_ = options.free_length_mm > 0.0 ? options.free_length_mm : bit.length_mm;
  const double narrow_mm = bit.shank_diameter_mm > 0.0 ? bit.shank_diameter_mm : bit.diameter_mm;
  const double full_mm4 = bit.is_plate() ? bit.diameter_mm * std::pow(bit.thickness_mm, 3) / 12.0
                                         : std::numbers::pi * std::pow(narrow_mm, 4) / 64.0;
  bending_n_mm2_ = 1e3 * options.young_gpa * full_mm4 * (bit.has_flutes() ? options.flutes_share : 1.0);
}

double CompliantTool::free_mm(double guided_mm) const noexcept {
  // A bit that is nearly all in its hole does not become stiffer without end: its chuck gives way too.
  constexpr double kShortest = 0.1;
  return std::max(length_mm_ - std::max(0.0, guided_mm), kShortest * length_mm_);
}

double CompliantTool::stiffness_n_mm(double guided_mm) const noexcept {
  return 3.0 * bending_n_mm2_ / std::pow(free_mm(guided_mm), 3);
}

Pose CompliantTool::real_pose(const Pose& commanded, const Met& met, double dt_s) noexcept {
  constexpr double kSettlesS = 0.01;  // longer than a cycle, shorter than a hand feels
  constexpr double kMostAside = 0.5;  // of an advance
  constexpr double kLeastThrustN = 1.0;
  const Vec3& axis = commanded.axis;
  const auto across = [&](const Vec3& of) { return Vec3(of - of.dot(axis) * axis); };
  off_mm_ = across(off_mm_);
  const double inside_mm = std::isfinite(met.tip.inside_mm) ? met.tip.inside_mm : 0.0;
  const double stiff_n_mm = stiffness_n_mm(inside_mm);
  const double slope = 1.5 / free_mm(inside_mm);  // of a cantilever's end, over how far it is bent
  const double thrust_n = met.force.thrust_n - std::min(0.0, met.force.contact_n.dot(axis));
  Vec3 pull_n = across(met.force.lateral_n) - stiff_n_mm * off_mm_;  // on the tip
  if (inside_mm >= options_.bite_mm) {
    Vec3 turned = pull_n / std::max(thrust_n, kLeastThrustN);
    if (turned.norm() > kMostAside) turned *= kMostAside / turned.norm();
    off_mm_ += std::max(0.0, met.advance_mm) * (slope * off_mm_ + turned);
  } else {
    if (thrust_n > 0.0) {
      // On a slope bone pushes along its normal, which drives the tip down the slope against friction.
      pull_n -= thrust_n * across(met.into_bone);
      const double held_n = options_.friction * thrust_n, pulls_n = pull_n.norm();
      pull_n *= pulls_n > held_n ? 1.0 - held_n / pulls_n : 0.0;
    }
    off_mm_ += dt_s / (kSettlesS + dt_s) * pull_n / stiff_n_mm;
  }
  // A bit bends by some diameters before it breaks.
  const double most_mm = 0.2 * length_mm_;
  if (off_mm_.norm() > most_mm) off_mm_ *= most_mm / off_mm_.norm();
  Pose real = commanded;
  real.tip_mm += off_mm_;
  real.axis = (axis + slope * off_mm_).normalized();
  return real;
}

Spindle CompliantTool::real_spindle(const Spindle& commanded, const Met& met, double dt_s) noexcept {
  constexpr double kDrawnBackMm = 0.5;
  constexpr double kStands = 0.02;  // of the speed
  Spindle real = commanded;
  if (!(commanded.rpm > 0.0)) {
    is_stalled_ = false;
    speed_share_ = 1.0;
    return real;
  }
  if (!(options_.stall_n_mm > 0.0)) return real;
  if (is_stalled_) {
    drawn_back_mm_ = std::max(0.0, drawn_back_mm_ - met.advance_mm);
    if (drawn_back_mm_ < kDrawnBackMm) {
      real.rpm = 0.0;
      return real;
    }
    is_stalled_ = false;
    speed_share_ = kStands;
  }
  const double line = std::clamp(1.0 - met.force.torque_n_mm / options_.stall_n_mm, 0.0, 1.0);
  speed_share_ += dt_s / (options_.spin_up_s + dt_s) * (line - speed_share_);
  if (speed_share_ < kStands) {
    is_stalled_ = true;
    drawn_back_mm_ = 0.0;
    speed_share_ = 0.0;
  }
  real.rpm *= speed_share_;
  return real;
}

}  // namespace spinaltap
