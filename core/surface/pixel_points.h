#pragma once

#include "core/ct/ct_volume.h"

namespace spinaltap {

/// The paper's surface pixels (its sections 3.3.1 and 3.4.1): voxels of the mask that have one of their four neighbours
/// in the slice (i or j one less or more) outside it.
struct PixelPoints {
  std::vector<std::array<int, 3>> voxels;  ///< slice by slice, row by row
  /// Of each, in patient LPS: the sum of the unit steps to the neighbours outside, not normalised. Zero where they
  /// cancel: ambiguous.
  std::vector<Vec3> outward;
};

PixelPoints surface_pixels(const BoneMask& mask);

/// The neighbours of surface pixels that are none themselves, each once: inside and outside the mask.
struct PixelNeighbours {
  std::vector<std::array<int, 3>> voxels;
  std::vector<std::size_t> of;  ///< index of the first surface pixel next to it
  std::vector<bool> is_inside;
};

PixelNeighbours neighbour_pixels(const BoneMask& mask, const PixelPoints& pixels);

}  // namespace spinaltap
