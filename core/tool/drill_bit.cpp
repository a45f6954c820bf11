#include "core/tool/drill_bit.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/base/error.h"
#include "core/tool/detail/outline_ball.h"

namespace spinaltap {
namespace {

struct WidestPlace {
  double back_mm = 0.0;
  double radius_mm = 0.0;
};

/// Where an outline is first as wide as anywhere.
WidestPlace widest_place(const std::vector<OutlinePoint>& outline) {
  WidestPlace widest;
  const auto take = [&](double back_mm, double radius_mm) {
    if (radius_mm > widest.radius_mm) widest = {back_mm, radius_mm};
  };
  for (std::size_t n = 0; n < outline.size(); ++n) {
    if (n > 0 && outline[n].is_arc) {
      const detail::OutlineBall ball = detail::ball_through(outline[n - 1], outline[n]);
      if (outline[n - 1].back_mm <= ball.centre_mm && ball.centre_mm <= outline[n].back_mm) {
        take(ball.centre_mm, ball.radius_mm);
      }
    }
    take(outline[n].back_mm, outline[n].radius_mm);
  }
  return widest;
}

void check_outline(const std::vector<OutlinePoint>& outline) {
  constexpr double kMaxBackMm = 500.0, kMaxRadiusMm = 100.0, kMaxBallMm = 1000.0;
  constexpr double kMinLengthMm = 1e-3, kMinRadiusMm = 0.01, kMaxSlope = 20.0;
  constexpr std::size_t kMaxPoints = kMaxStretches + 1;
  const std::size_t count = outline.size();
  if (count < 2 || count > kMaxPoints) {
    fail("drill bit: expected an outline of 2 to ", kMaxPoints, " places, found ", count);
  }
  for (std::size_t n = 0; n < count; ++n) {
    const OutlinePoint& to = outline[n];
    const auto within = [&](double value_mm, double low_mm, double high_mm, const char* what) {
      if (!(value_mm >= low_mm && value_mm <= high_mm)) {
        fail("drill bit: place ", n + 1, " of the outline: expected ", what, " from ", low_mm, " to ", high_mm,
             " mm, found ", value_mm, " mm");
      }
    };
    const auto expect = [&](bool is_so, const char* what) {
      if (!is_so) {
        fail("drill bit: place ", n + 1, " of the outline: expected ", what, ", found it ", to.back_mm,
             " mm back with a radius of ", to.radius_mm, " mm", to.is_arc ? ", by an arc" : "");
      }
    };
    within(to.back_mm, 0.0, kMaxBackMm, "a distance back from the tip");
    within(to.radius_mm, 0.0, kMaxRadiusMm, "a radius");
    if (n == 0) {
      expect(to.back_mm == 0.0 && !to.is_arc, "the tip, 0 mm back and without an arc");
      continue;
    }
    const OutlinePoint& from = outline[n - 1];
    const double length_mm = to.back_mm - from.back_mm;
    expect(length_mm >= 0.0, "it no nearer to the tip than the place before");
    // A cone's apex far from the tip would be lost in rounding.
    expect(to.radius_mm >= kMinRadiusMm || (n + 1 == count && to.is_arc && to.radius_mm == 0.0),
           "a radius of at least 0.01 mm behind the tip, or 0 where an arc ends it");
    if (length_mm == 0.0) {
      expect(!to.is_arc, "an arc to lead further back");
      expect(to.radius_mm != from.radius_mm, "another place than the one before");
      expect(n < 2 || outline[n - 2].back_mm < to.back_mm, "no more than two places as far back");
      expect(n > 1 || to.radius_mm > from.radius_mm, "a flat tip to widen");
      expect(n + 1 < count || to.radius_mm < from.radius_mm, "a flat base to narrow");
      continue;
    }
    expect(length_mm >= kMinLengthMm, "it at least 0.001 mm further back than the place before");
    if (to.is_arc) {
      within(detail::ball_through(from, to).radius_mm, 0.0, kMaxBallMm, "an arc of a ball with a radius");
    } else {
      expect(std::abs(to.radius_mm - from.radius_mm) <= kMaxSlope * length_mm,
             "a slope of at most 20 mm a mm, or a flat face as far back");
    }
  }
}

/// Outline and sizes; without one, that the shape has none.
void check_profile_bit(const DrillBit& bit) {
  if (bit.shape != BitShape::profile) {
    if (!bit.outline.empty()) fail("drill bit: expected an outline of profiles only");
    return;
  }
  check_outline(bit.outline);
  const WidestPlace widest = widest_place(bit.outline);
  if (bit.diameter_mm != 2.0 * widest.radius_mm || bit.length_mm != bit.outline.back().back_mm ||
      bit.tip_length_mm != widest.back_mm || bit.tip_diameter_mm != 0.0 || bit.shank_diameter_mm != 0.0) {
    fail("drill bit: expected a profile with the sizes of its outline, ", 2.0 * widest.radius_mm, " x ",
         bit.outline.back().back_mm, " mm, found ", bit.diameter_mm, " x ", bit.length_mm, " mm");
  }
}

/// Sizes of a plate; that other shapes have none.
void check_plate(const DrillBit& bit) {
  constexpr double kMaxWidthMm = 200.0, kMaxLengthMm = 500.0, kMinThicknessMm = 0.05;
  if (!bit.is_plate()) {
    if (bit.thickness_mm != 0.0 || bit.stroke_mm != 0.0)
      fail("drill bit: expected thickness and stroke of plates only");
    return;
  }
  const auto within = [](double value_mm, double low_mm, double high_mm, const char* what) {
    if (!(value_mm >= low_mm && value_mm <= high_mm)) {
      fail("plate: expected a ", what, " from ", low_mm, " to ", high_mm, " mm, found ", value_mm, " mm");
    }
  };
  within(bit.diameter_mm, kMinThicknessMm, kMaxWidthMm, "width");
  within(bit.thickness_mm, kMinThicknessMm, bit.diameter_mm, "thickness");
  within(bit.length_mm, kMinThicknessMm, kMaxLengthMm, "length");
  if (!(bit.stroke_mm >= 0.0 && bit.stroke_mm < bit.diameter_mm)) {
    fail("plate: expected a stroke from 0 to below the width of ", bit.diameter_mm, " mm, found ", bit.stroke_mm,
         " mm");
  }
  if (!bit.width_along.allFinite() || !(std::abs(bit.width_along.norm() - 1.0) < 1e-6)) {
    fail("plate: expected a direction of length 1 that its width lies along");
  }
  if (bit.tip_length_mm != 0.0 || bit.tip_diameter_mm != 0.0 || bit.shank_diameter_mm != 0.0) {
    fail("plate: expected neither tip nor shank");
  }
}

/// Helix and wear; that other shapes have the defaults.
void check_flutes(const DrillBit& bit) {
  if (!bit.has_flutes()) {
    const DrillBit usual;
    if (bit.helix_deg != usual.helix_deg || bit.wear_mm != usual.wear_mm) {
      fail("drill bit: expected a helix and wear of drills only");
    }
    return;
  }
  if (!(bit.helix_deg >= 0.0 && bit.helix_deg <= 60.0)) {
    fail("drill bit: expected a helix of 0 to 60 degrees, found ", bit.helix_deg);
  }
  if (!(bit.wear_mm >= 0.0 && bit.wear_mm <= 1.0)) {
    fail("drill bit: expected wear of 0 to 1 mm, found ", bit.wear_mm, " mm");
  }
}

/// Unit, across `axis`, as nearly along `wanted` as can be; nothing where that is within a sine of 0.1 of the axis.
std::optional<Vec3> side_along(const Vec3& wanted, const Vec3& axis) {
  constexpr double kLeastSine = 0.1;
  const Vec3 across = wanted - wanted.dot(axis) * axis;
  const double length = across.norm();
  if (!(length >= kLeastSine)) return std::nullopt;
  return across / length;
}

}  // namespace

DrillBit plate_bit(double width_mm, double thickness_mm, double length_mm, double stroke_mm) {
  DrillBit bit{width_mm, length_mm, 0.0, BitShape::plate};
  bit.thickness_mm = thickness_mm;
  bit.stroke_mm = stroke_mm;
  check_bit(bit);
  return bit;
}

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

DrillBit profile_bit(std::vector<OutlinePoint> outline) {
  check_outline(outline);
  const WidestPlace widest = widest_place(outline);
  DrillBit bit{2.0 * widest.radius_mm, outline.back().back_mm, widest.back_mm, BitShape::profile};
  bit.outline = std::move(outline);
  check_bit(bit);
  return bit;
}

DrillBit resized(const DrillBit& bit, double diameter_mm, double length_mm) {
  check_bit(bit);
  const double share = diameter_mm / bit.diameter_mm;
  if (bit.shape == BitShape::profile) {
    std::vector<OutlinePoint> outline = bit.outline;
    for (OutlinePoint& point : outline) {
      point.back_mm *= share;
      point.radius_mm *= share;
    }
    OutlinePoint& base = outline.back();
    if (!base.is_arc && base.radius_mm == outline[outline.size() - 2].radius_mm) base.back_mm = length_mm;
    return profile_bit(std::move(outline));
  }
  DrillBit other = bit;
  other.diameter_mm = diameter_mm;
  other.length_mm = length_mm;
  other.tip_length_mm *= share;
  other.tip_diameter_mm *= share;
  other.shank_diameter_mm *= share;
  other.thickness_mm *= share;
  other.stroke_mm *= share;
  check_bit(other);
  return other;
}

void check_bit(const DrillBit& bit) {
  check_flutes(bit);
  check_profile_bit(bit);
  check_plate(bit);
  if (bit.shape == BitShape::profile || bit.is_plate()) return;
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

std::optional<Pose> valid_pose(const Pose& pose, const DrillBit& bit) noexcept {
  constexpr double kUnitTolerance = 0.01, kExact = 1e-9;
  const double length = pose.axis.norm();
  if (!pose.tip_mm.allFinite() || !(std::abs(length - 1.0) < kUnitTolerance)) return std::nullopt;
  // A unit axis stays what it is, to the last bit.
  Pose sound{pose.tip_mm, std::abs(length - 1.0) < kExact ? pose.axis : Vec3(pose.axis / length)};
  if (!bit.is_plate()) return sound;
  const bool is_said = !(pose.side.array() == 0.0).all();
  if (is_said) {
    const double wide = pose.side.norm(), along = pose.side.dot(sound.axis);
    if (!(std::abs(wide - 1.0) < kUnitTolerance && std::abs(along) < kUnitTolerance)) return std::nullopt;
    sound.side = pose.side;
    if (std::abs(wide - 1.0) < kExact && std::abs(along) < kExact) return sound;
  }
  const std::optional<Vec3> side = side_along(is_said ? pose.side : bit.width_along, sound.axis);
  if (!side) return std::nullopt;
  sound.side = *side;
  return sound;
}

double max_displacement_mm(const Pose& from, const Pose& to, double length_mm) noexcept {
  const Vec3 tip_way_mm = to.tip_mm - from.tip_mm;
  const Vec3 base_way_mm = tip_way_mm - length_mm * (to.axis - from.axis);
  return std::max(tip_way_mm.norm(), base_way_mm.norm());
}

}  // namespace spinaltap
