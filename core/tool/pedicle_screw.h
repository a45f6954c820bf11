#pragma once

#include <string>

#include "core/tool/drill_bit.h"

namespace spinaltap {

/// A screw for a pedicle. Lengths in mm.
struct PedicleScrew {
  std::string name;            ///< as its maker or its table calls it
  double diameter_mm = 6.5;    ///< over the thread
  double length_mm = 45.0;     ///< from under the head to the tip
  double tip_length_mm = 4.0;  ///< of the cone at the tip, in length_mm

  double radius_mm() const { return 0.5 * diameter_mm; }
  /// The body that the turning thread fills.
  DrillBit outline() const { return {diameter_mm, length_mm, tip_length_mm}; }
};

/// Refuses what check_bit() refuses of its outline.
void check_screw(const PedicleScrew& screw);

}  // namespace spinaltap
