#pragma once

#include "core/segment/float_grid.h"

namespace spinaltap {

/// Grey-value morphology with a box of `reach_mm` on each side of a voxel, at least one voxel.
struct GreyClosing {
  std::vector<float> peak;    ///< the largest value within the box
  std::vector<float> closed;  ///< the smallest peak within the box: dark gaps narrower than the box are gone
};

GreyClosing close_gaps(const FloatGrid& grid, double reach_mm);

}  // namespace spinaltap
