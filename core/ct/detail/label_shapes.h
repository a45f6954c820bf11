#pragma once

#include <map>
#include <optional>
#include <string>

#include "core/base/geometry.h"
#include "core/ct/level.h"

namespace spinaltap::detail {

/// What one label of a map looks like, on the map's own grid.
struct LabelShape {
  Vec3 middle_mm = Vec3::Zero();  ///< mean of its voxels, patient LPS
  Vec3 size_mm = Vec3::Zero();    ///< of its box: across, front to back, top to bottom
  double volume_mm3 = 0.0;
  bool is_cut = false;  ///< it reaches the map's border, so that part of it may be missing
};

/// Why a label of this shape cannot be a level, in words ("93 mm across, 86 at most"); nothing where it can.
/// `is_body`: labels are bodies without arches.
std::optional<std::string> why_not(const LabelShape& shape, Level level, bool is_body);

/// Why two labels cannot be a level and the one below it: their middles are too near or too far from each other.
std::optional<std::string> why_not_neighbours(const LabelShape& upper, const LabelShape& lower, Level level);

}  // namespace spinaltap::detail
