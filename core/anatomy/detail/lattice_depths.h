#pragma once

#include "core/anatomy/point_tree.h"
#include "core/base/progress.h"
#include "core/segment/float_grid.h"

namespace spinaltap {

/// The lattice with its values up to `-trusted_band_mm` replaced by minus the distances (mm) to the nearest point of
/// the surface; deeper than 3 mm they are up to 0.1 mm more.
FloatGrid with_depths(FloatGrid lattice, const PointTree& surface, double trusted_band_mm, const Progress& progress);

}  // namespace spinaltap
