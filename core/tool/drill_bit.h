#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/base/geometry.h"

namespace spinaltap {

/// Shapes of tools. All but the plate are bodies of revolution: what a turning tool sweeps.
enum class BitShape {
  drill,          ///< a cylinder with a conical tip; with a tip diameter: a twist drill, whose chisel edge is that wide
  round_burr,     ///< a ball on a shank; `tip_length_mm` is not used
  conical_burr,   ///< a frustum from the tip's diameter to the bit's over the tip's length, on a shank
  tapered_screw,  ///< a cone to the tip's diameter over the tip's length, then a taper to the bit's diameter at the
                  ///< base
  profile,        ///< of any outline, see profile_bit(): match-heads, reamers, taps, probes
  plate           ///< a flat blade, the kerf of a saw or an osteotome: a box, see plate_bit()
};

/// A place of an outline, mm, and what leads to it from the place before.
struct OutlinePoint {
  double back_mm = 0.0;    ///< from the tip
  double radius_mm = 0.0;  ///< off the axis
  /// Led to along a ball with its centre on the axis, of which two places leave only one; else by a straight line,
  /// which is a flat face between places that are as far back.
  bool is_arc = false;

  bool operator==(const OutlinePoint&) const = default;
};

/// A tool. Lengths in mm. The defaults are the paper's bit.
struct DrillBit {
  double diameter_mm = 3.0;  ///< where the bit is widest; of a plate: its width
  double length_mm = 50.0;   ///< from the base to the tip, tip included
  double tip_length_mm = 5.0;
  BitShape shape = BitShape::drill;
  double tip_diameter_mm = 0.0;    ///< drill: of the chisel edge; see BitShape for the others
  double shank_diameter_mm = 0.0;  ///< of burrs, behind the head
  /// Of a profile, from the tip to the base; the others have none. The sizes above follow from it.
  std::vector<OutlinePoint> outline = {};
  // Of plates; the others have neither.
  double thickness_mm = 0.0;  ///< of the kerf, at most the width
  double stroke_mm = 0.0;     ///< how far a saw's teeth go to and fro along the width; 0: an osteotome, which is driven
  /// How a plate is held where poses do not say: its width as nearly along this as the axis lets it, unit, patient LPS.
  Vec3 width_along = Vec3::UnitZ();
  // Of drills, for the mechanistic law; the defaults: a usual surgical drill, sharp.
  double helix_deg = 25.0;  ///< of the flutes at the rim
  double wear_mm = 0.0;     ///< height of the flat that wear has ground behind each lip

  double radius_mm() const { return 0.5 * diameter_mm; }
  /// Else it turns, and is what it sweeps in a turn.
  bool is_plate() const { return shape == BitShape::plate; }
  /// Has lips, and lands behind them, wound by a helix.
  bool has_flutes() const { return shape == BitShape::drill; }
  /// How far back its cutting head ends: where it is widest.
  double head_mm() const { return shape == BitShape::round_burr ? radius_mm() : tip_length_mm; }
  bool operator==(const DrillBit&) const = default;
};

/// What an outline may have of straight lines, flat faces and arcs.
inline constexpr std::size_t kMaxStretches = 16;

/// A bit of any outline: its diameter and its length are the outline's, its tip ends where it is first as wide as
/// anywhere. Throws Error as check_bit does.
DrillBit profile_bit(std::vector<OutlinePoint> outline);

/// A blade of `width_mm` across and `thickness_mm`, from its edge `length_mm` back; with a stroke, a saw, whose width
/// is that of the kerf, stroke included. Throws Error as check_bit does.
DrillBit plate_bit(double width_mm, double thickness_mm, double length_mm, double stroke_mm = 0.0);

/// The same tool in another size: tip, chisel edge and shank go with the diameter, a plate's thickness and stroke with
/// its width. A profile is scaled as a whole; where it ends in a cylinder that makes up the length, and elsewhere the
/// length is scaled too. Throws Error as check_bit does.
DrillBit resized(const DrillBit& bit, double diameter_mm, double length_mm);

/// A twist drill's outline. `point_angle_deg`: of the whole tip, 118 for most drills. `chisel_edge_mm`: its width.
/// Throws Error on angles that are not between 20 and 180 degrees.
DrillBit twist_drill(double diameter_mm, double length_mm, double point_angle_deg, double chisel_edge_mm);

/// Rejects lengths that are not finite or not above 0, tips longer than the bit, shanks and tips wider than it, helices
/// not from 0 to 60 degrees and wear not from 0 to 1 mm, and either of other tools than drills. Of
/// profiles, outlines of more than kMaxStretches or that do not begin at the tip and go back from there; places further
/// than 500 mm back or 100 mm off the axis, and behind the tip those less than 0.01 mm off it, but where an arc closes
/// the base; straight stretches that widen or narrow by more than 20 mm a mm and are not flat faces, stretches shorter
/// than 0.001 mm, and arcs of balls larger than 1000 mm. Of plates, those wider than 200 mm, thicker than wide or
/// thinner than 0.05 mm, strokes that are not below the width, and a width along nothing.
void check_bit(const DrillBit& bit);

/// Where a tool is: its tip and the direction it drills in; of a plate, which way it is turned about that.
struct Pose {
  Vec3 tip_mm = Vec3::Zero();  ///< of a plate: the middle of its edge
  Vec3 axis = Vec3::UnitZ();   ///< unit, from the base to the tip
  /// Unit, across the axis, along a plate's width; zero: not said, as of bodies of revolution, which are the same
  /// whichever way they are turned.
  Vec3 side = Vec3::Zero();
};

/// The pose that a device or a file gave, with a unit axis; nothing where a number is not finite or the axis not a unit
/// one within 0.01, which is more than floats round. Of a plate with a unit side across the axis: the pose's own, which
/// may be as much off, or that of DrillBit::width_along; nothing where the axis lies within 6 degrees of that.
std::optional<Pose> valid_pose(const Pose& pose, const DrillBit& bit) noexcept;

/// How far a bit's tip moves from one pose to another, or its base, `length_mm` behind it, where that is more: what a
/// longest jump is held against.
double max_displacement_mm(const Pose& from, const Pose& to, double length_mm) noexcept;

}  // namespace spinaltap
