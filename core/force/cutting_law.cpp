#include "core/force/cutting_law.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/error.h"

namespace spinaltap {
namespace {

constexpr double kTurnOfTool = 2.0 * std::numbers::pi;
constexpr double kRightAngle = 0.5 * std::numbers::pi;
/// Below this feed per turn the chisel edge does not press with all of its force: a bit at rest presses with none.
constexpr double kChiselFeedMm = 1e-3;
/// Of the point that the material's numbers are for, and of the chisel edge to the lips: those of usual drills.
constexpr double kUsualPointDeg = 118.0, kChiselAngleDeg = 125.0;
/// Width of a margin over the diameter; there are two.
constexpr double kMarginShare = 0.08;
/// Of the force on a chip off its way. A rake further back shears no chip but pushes bone aside, with no more than
/// that.
constexpr double kMaxLean = 80.0 * std::numbers::pi / 180.0;
/// Pieces of a lip: the rake's closed form is smooth, and midpoints are right to 1e-4.
constexpr int kLipPieces = 32;

constexpr double in_radians(double degrees) { return degrees * std::numbers::pi / 180.0; }

double chisel_radius_of(const DrillBit& bit, const Material& material) {
  const bool has_edge = bit.has_flutes() && bit.tip_diameter_mm > 0.0;
  return has_edge ? 0.5 * bit.tip_diameter_mm : 0.5 * material.chisel_share * bit.diameter_mm;
}

/// Of what a tool cuts out on its way along its axis.
double section_of(const DrillBit& bit) {
  return bit.is_plate() ? bit.diameter_mm * bit.thickness_mm : std::numbers::pi * bit.radius_mm() * bit.radius_mm();
}

double half_point_angle(const DrillBit& bit) {
  if (!bit.has_flutes()) return in_radians(0.5 * kUsualPointDeg);
  return std::atan2(0.5 * (bit.diameter_mm - bit.tip_diameter_mm), bit.tip_length_mm);
}

/// Across the lip, of a drill with the helix's tangent at the rim; `radius`: over the rim's; `web`: half its thickness
/// over the rim's radius.
double normal_rake(double radius, double helix_tangent, double web, double half_point) {
  const double web_angle = std::asin(std::min(web / radius, 1.0));
  const double helix = radius * helix_tangent;
  return std::atan2(helix * std::cos(web_angle),
                    std::sin(half_point) - helix * std::cos(half_point) * std::sin(web_angle)) -
         std::atan(std::tan(web_angle) * std::cos(half_point));
}

/// Cotangent of the shear angle of Ernst & Merchant: the force along the cut is twice this times strength and section
/// of the chip.
double shear_cotangent(double friction, double rake) {
  const double lean = std::min(friction - rake, kMaxLean);
  return 1.0 / std::tan(0.5 * kRightAngle - 0.5 * lean);
}

double thrust_over_cut(double friction, double rake) { return std::tan(std::min(friction - rake, kMaxLean)); }

double power_of_feed_mm(double feed_mm, double reference_mm, double exponent) {
  return feed_mm > 0.0 ? feed_mm * std::pow(feed_mm / reference_mm, -exponent) : 0.0;
}

double chisel_share_of(double feed_mm) { return std::clamp(feed_mm / kChiselFeedMm, 0.0, 1.0); }

}  // namespace

double CuttingResistance::thrust_n(double feed_mm_per_turn) const noexcept {
  return lips_n / reference_feed_mm * power_of_feed_mm(feed_mm_per_turn, reference_feed_mm, feed_exponent) +
         chisel_n * chisel_share_of(feed_mm_per_turn);
}

double CuttingResistance::torque_n_mm(double feed_mm_per_turn) const noexcept {
  return lips_n_mm / reference_feed_mm * power_of_feed_mm(feed_mm_per_turn, reference_feed_mm, feed_exponent) +
         rubbing_n_mm(feed_mm_per_turn);
}

double CuttingResistance::rubbing_n_mm(double feed_mm_per_turn) const noexcept {
  return rub_n_mm * chisel_share_of(feed_mm_per_turn);
}

ToolLaw::ToolLaw(const DrillBit& bit, const Material& material)
    : radius_mm_(bit.radius_mm()),
      is_plate_(bit.is_plate()),
      stroke_mm_(bit.stroke_mm),
      section_mm2_(section_of(bit)),
      chisel_radius_mm_(chisel_radius_of(bit, material)),
      reference_feed_mm_(material.reference_feed_mm),
      feed_exponent_(material.feed_exponent),
      lip_thrust_share_(material.lip_thrust_share) {
  check_bit(bit);
  check_material(material);
  if (material.law == CuttingLaw::mechanistic && !is_plate_) take_lips(bit, material);
}

void ToolLaw::take_lips(const DrillBit& bit, const Material& material) {
  const LipMechanics& lips = material.lips;
  const double friction = in_radians(lips.friction_deg);
  const double half_point = half_point_angle(bit);
  const double chisel = std::min(chisel_radius_mm_ / radius_mm_, 0.99);
  const double helix_tangent = bit.has_flutes() ? std::tan(in_radians(bit.helix_deg)) : 0.0;
  const double web = bit.has_flutes() ? chisel * std::sin(in_radians(kChiselAngleDeg)) : 0.0;

  const double even = shear_cotangent(friction, 0.0);
  double torque = 0.0, thrust = 0.0;
  const double piece = (1.0 - chisel) / kLipPieces;
  for (int n = 0; n < kLipPieces; ++n) {
    const double radius = chisel + (n + 0.5) * piece;
    const double rake = normal_rake(radius, helix_tangent, web, half_point);
    const double cut = shear_cotangent(friction, rake) / even * std::pow(radius, lips.speed_exponent);
    torque += 2.0 * cut * radius * piece;
    thrust += cut * thrust_over_cut(friction, rake) * piece;
  }
  // A sharper point has longer lips, which cut a thinner chip.
  torque_factor_ =
      torque * std::pow(std::sin(half_point) / std::sin(in_radians(0.5 * kUsualPointDeg)), -material.feed_exponent);
  lip_thrust_share_ = thrust * std::sin(half_point) / torque;
  speed_exponent_ = lips.speed_exponent;
  reference_rpm_ = lips.reference_rpm;

  const double pressure_share =
      material.specific_cutting_energy_mpa > 0.0 ? material.chisel_mpa / material.specific_cutting_energy_mpa : 0.0;
  flank_mm2_ = bit.has_flutes() ? 2.0 * bit.wear_mm * (radius_mm_ - chisel_radius_mm_) * pressure_share : 0.0;
  flank_torque_mm_ = std::tan(friction) / std::sin(half_point) * 0.5 * (radius_mm_ + chisel_radius_mm_);
  if (bit.has_flutes()) {
    margin_mm2_ = std::tan(friction) * lips.margin_pressure_share * 2.0 * kMarginShare * bit.diameter_mm * radius_mm_;
    chip_share_per_mm_ = lips.chip_torque_per_diameter / bit.diameter_mm;
  }
}

double ToolLaw::speed_factor(double rpm) const noexcept {
  return speed_exponent_ > 0.0 ? std::pow(rpm / reference_rpm_, speed_exponent_) : 1.0;
}

double ToolLaw::energy_factor(double rpm) const noexcept { return torque_factor_ * speed_factor(rpm); }

double ToolLaw::chips_factor(double depth_mm) const noexcept { return 1.0 + chip_share_per_mm_ * depth_mm; }

double ToolLaw::feed_times_factor_mm(double feed_mm) const noexcept {
  return power_of_feed_mm(feed_mm, reference_feed_mm_, feed_exponent_);
}

CuttingResistance ToolLaw::resistance(const EngagedBone& bone, double rpm) const noexcept {
  CuttingResistance resistance;
  resistance.reference_feed_mm = reference_feed_mm_;
  resistance.feed_exponent = feed_exponent_;
  if (is_plate_) {
    // A saw's teeth share the energy of a stroke's feed out over the stroke, to and fro; a driven edge indents.
    if (stroke_mm_ > 0.0) {
      resistance.lips_n = lip_thrust_share_ * bone.energy_n * reference_feed_mm_ / (2.0 * stroke_mm_);
    } else {
      resistance.chisel_n = bone.chisel_mpa * section_mm2_;
    }
    return resistance;
  }
  const double speed = speed_factor(rpm);
  const double lips_n_mm = torque_factor_ * speed * bone.energy_n * reference_feed_mm_ / kTurnOfTool;
  resistance.lips_n_mm = lips_n_mm * chips_factor(bone.hole.depth_mm);
  resistance.lips_n = lip_thrust_share_ * 2.0 * lips_n_mm / radius_mm_;
  const double flanks_n = flank_mm2_ * bone.energy_n / section_mm2_;
  resistance.chisel_n = bone.chisel_mpa * std::numbers::pi * chisel_radius_mm_ * chisel_radius_mm_ + flanks_n;
  resistance.rub_n_mm = flank_torque_mm_ * flanks_n + margin_mm2_ * bone.hole.energy_mpa * bone.hole.depth_mm;
  return resistance;
}

CuttingResistance resistance_of_block(const DrillBit& bit, const Material& material, double hu, double rpm,
                                      double depth_mm) {
  const ToolLaw law(bit, material);
  const double energy_mpa = material.cutting_energy_mpa(hu);
  return law.resistance({energy_mpa * law.section_mm2(), material.chisel_pressure_mpa(hu), {depth_mm, energy_mpa}},
                        rpm);
}

}  // namespace spinaltap
