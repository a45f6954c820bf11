#include "core/tool/drill_bit.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/error.h"

namespace spinaltap {

DrillBit twist_drill(double diameter_mm, double length_mm, double point_angle_deg, double chisel_edge_mm) {
  if (!(point_angle_deg >= 20.0 && point_angle_deg < 180.0)) {
    fail("drill bit: expected a point angle of 20 to below 180 degrees, found ", point_angle_deg);
  }
  const double half_angle = 0.5 * point_angle_deg * std::numbers::pi / 180.0;
  DrillBit bit{diameter_mm, length_mm, 0.5 * (diameter_mm - chisel_edge_mm) / std::tan(half_angle)};
  bit.tip_diameter_mm = chisel_edge_mm;
  check_bit(bit);
  return bit;
}

void check_bit(const DrillBit& bit) {
  const auto above_zero = [](double length_mm, const char* what) {
    if (!(length_mm > 0.0) || !std::isfinite(length_mm)) {
      fail("drill bit: expected a ", what, " above 0 mm, found ", length_mm, " mm");
    }
  };
  const auto within = [&](double diameter_mm, const char* what) {
    if (!(diameter_mm >= 0.0 && diameter_mm <= bit.diameter_mm)) {
      fail("drill bit: expected a ", what, " from 0 to the bit's ", bit.diameter_mm, " mm, found ", diameter_mm, " mm");
    }
  };
  above_zero(bit.diameter_mm, "diameter");
  above_zero(bit.length_mm, "length");
  within(bit.tip_diameter_mm, "tip diameter");
  within(bit.shank_diameter_mm, "shank diameter");
  if (bit.shape == BitShape::round_burr) {
    if (!(bit.length_mm > 0.5 * bit.diameter_mm)) {
      fail("drill bit: expected a burr longer than its ball's radius, found ", bit.length_mm, " mm for ",
           bit.diameter_mm, " mm of diameter");
    }
    return;
  }
  above_zero(bit.tip_length_mm, "tip length");
  if (bit.tip_length_mm > bit.length_mm) {
    fail("drill bit: expected a tip no longer than the bit, found ", bit.tip_length_mm, " mm of ", bit.length_mm,
         " mm");
  }
  if (bit.shape == BitShape::tapered_screw && bit.tip_length_mm < bit.length_mm) {
    above_zero(bit.tip_diameter_mm, "tip diameter of a screw");
  }
}

std::optional<Pose> sound_pose(const Pose& pose) noexcept {
  constexpr double kUnitTolerance = 0.01;
  const double length = pose.axis.norm();
  if (!pose.tip_mm.allFinite() || !(std::abs(length - 1.0) < kUnitTolerance)) return std::nullopt;
  // A unit axis stays what it is, to the last bit.
  return std::abs(length - 1.0) < 1e-9 ? pose : Pose{pose.tip_mm, pose.axis / length};
}

double longest_way_mm(const Pose& from, const Pose& to, double length_mm) noexcept {
  const Vec3 tip_way_mm = to.tip_mm - from.tip_mm;
  const Vec3 base_way_mm = tip_way_mm - length_mm * (to.axis - from.axis);
  return std::max(tip_way_mm.norm(), base_way_mm.norm());
}

}  // namespace spinaltap
