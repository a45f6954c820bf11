#pragma once

#include "core/base/geometry.h"

namespace spinaltap {

/// A cylindrical drill bit with a conical tip. Lengths in mm.
struct DrillBit {
  double diameter_mm = 3.0;
  double length_mm = 50.0;     ///< from the base to the tip, cone included
  double tip_length_mm = 5.0;  ///< of the cone

  double radius_mm() const { return 0.5 * diameter_mm; }
};

/// Refuses lengths that are not above 0 or not finite, and a cone longer than the bit.
void check_bit(const DrillBit& bit);

/// Where a bit is: its tip and the direction it drills in.
struct Pose {
  Vec3 tip_mm = Vec3::Zero();
  Vec3 axis = Vec3::UnitZ();  ///< unit, from the base to the tip
};

/// Whether the bit at `pose` holds point p (same frame as the pose, mm). The surface counts as inside.
/// The paper's algorithm 1, with the cone's factor the right way up: the allowed radius is
/// (1 - alpha) * length / tip_length of the bit's radius, where alpha runs from 0 at the base to 1 at the tip.
bool bit_contains(const DrillBit& bit, const Pose& pose, const Vec3& p);

/// Exact signed distance (mm) from p to the bit's surface at `pose`; negative inside.
double bit_distance_mm(const DrillBit& bit, const Pose& pose, const Vec3& p);

}  // namespace spinaltap
