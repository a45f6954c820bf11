#pragma once

#include <cstddef>
#include <vector>

#include "core/ct/ct_volume.h"
#include "core/segment/level_warnings.h"

namespace spinaltap {

/// What the voxels of a mask enclose. A vertebra is one piece with one handle, the ring around the canal: so is each of
/// those wholly in view in the label maps of two CTs at 1.5 and 3 mm.
struct MaskShape {
  std::size_t pieces = 0;      ///< that share no corner
  double largest_share = 0.0;  ///< of the voxels, in the largest piece
  double hollow_share = 0.0;   ///< voxels of the hollows that it encloses, over its own
  long handles = 0;            ///< holes through it: pieces + hollows - Euler number
  double depth_mm = 0.0;       ///< of the voxel that is farthest from any outside, between centres
};

/// Measures a mask; all 0 where it has no voxel. Throws Error when it has not as many as its geometry says.
MaskShape measure_shape(const BoneMask& mask);

/// What no whole bone has: pieces, hollows, many handles, no depth. `is_whole_vertebra`: also where it has no handle,
/// so that no arch closes round a canal.
std::vector<LevelWarning> check_shape(const MaskShape& shape, bool is_whole_vertebra);

}  // namespace spinaltap
