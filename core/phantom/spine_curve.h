#pragma once

#include <vector>

#include "core/phantom/level_measures.h"
#include "core/phantom/spine_options.h"
#include "core/phantom/vertebra_anatomy.h"

namespace spinaltap {

/// A level with its measures in its place.
struct PlacedLevel {
  Level level = Level::kNone;
  LevelMeasures measures;
  double side_wedge_deg = 0.0;       ///< of its body
  Mat3 rotation = Mat3::Identity();  ///< from the vertebra's own frame to the patient's
  Vec3 position_mm = Vec3::Zero();   ///< of the middle of its body
};

/// The levels from the uppermost to the lowest, and the sacrum where it is asked for, along the natural curve: each
/// flexed as its measures say, bent sidewise for a scoliosis, its body wedged along with the curve, the backs of the
/// bodies in line, a disc between each two. Throws Error as check_spine_options() does.
std::vector<PlacedLevel> place_levels(const SpineOptions& options);

/// The one of a level; null where it is not among them.
const PlacedLevel* placed_level(const std::vector<PlacedLevel>& placed, Level level);

/// Height of a disc between two levels in its middle, mm.
double disc_height_mm(const PlacedLevel& above, const PlacedLevel& below);

}  // namespace spinaltap
