#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/ct/grid_geometry.h"
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

/// Measures the voxels where `inside` is not 0, i fastest; only the size and the spacing of `geometry` count. All 0
/// where there is none. Throws Error when the sizes differ.
MaskShape measure_shape(std::span<const std::uint8_t> inside, const GridGeometry& geometry);

/// What no whole bone has: pieces, hollows, many handles, no depth. `is_whole_vertebra`: also where it has no handle,
/// so that no arch closes round a canal.
std::vector<LevelWarning> check_shape(const MaskShape& shape, bool is_whole_vertebra);

}  // namespace spinaltap
