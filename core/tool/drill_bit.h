#pragma once

#include <optional>

#include "core/base/geometry.h"

namespace spinaltap {

/// Shapes of rotating tools. All are bodies of revolution: what a turning tool sweeps.
enum class BitShape {
  drill,         ///< a cylinder with a conical tip; with a tip diameter: a twist drill, whose chisel edge is that wide
  round_burr,    ///< a ball on a shank; `tip_length_mm` is not used
  conical_burr,  ///< a frustum from the tip's diameter to the bit's over the tip's length, on a shank
  tapered_screw  ///< a cone to the tip's diameter over the tip's length, then a taper to the bit's diameter at the base
};

/// A rotating tool. Lengths in mm. The defaults are the paper's bit.
struct DrillBit {
  double diameter_mm = 3.0;  ///< where the bit is widest
  double length_mm = 50.0;   ///< from the base to the tip, tip included
  double tip_length_mm = 5.0;
  BitShape shape = BitShape::drill;
  double tip_diameter_mm = 0.0;    ///< drill: of the chisel edge; see BitShape for the others
  double shank_diameter_mm = 0.0;  ///< of burrs, behind the head

  double radius_mm() const { return 0.5 * diameter_mm; }
};

/// A twist drill's outline. `point_angle_deg`: of the whole tip, 118 for most drills. `chisel_edge_mm`: its width.
/// Throws Error on angles that are not between 20 and 180 degrees.
DrillBit twist_drill(double diameter_mm, double length_mm, double point_angle_deg, double chisel_edge_mm);

/// Rejects lengths that are not finite or not above 0, tips longer than the bit, shanks and tips wider than it.
void check_bit(const DrillBit& bit);

/// Where a bit is: its tip and the direction it drills in.
struct Pose {
  Vec3 tip_mm = Vec3::Zero();
  Vec3 axis = Vec3::UnitZ();  ///< unit, from the base to the tip
};

/// The pose that a device or a file gave, with a unit axis; nothing where a number is not finite or the axis not a unit
/// one within 0.01, which is more than floats round.
std::optional<Pose> sound_pose(const Pose& pose) noexcept;

/// How far a bit's tip moves from one pose to another, or its base, `length_mm` behind it, where that is more: what a
/// longest jump is held against.
double longest_way_mm(const Pose& from, const Pose& to, double length_mm) noexcept;

}  // namespace spinaltap
