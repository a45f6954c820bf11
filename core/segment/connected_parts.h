#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/ct/grid_geometry.h"

namespace spinaltap {

/// The face-connected part of the voxels where `inside` is not 0 that holds `seed` (an offset); 1 in the part, 0
/// elsewhere.
std::vector<std::uint8_t> connected_part(std::span<const std::uint8_t> inside, const GridGeometry& geometry,
                                         std::size_t seed);

/// The face-connected part with the most voxels; of equal ones the first in memory. All 0 when nothing is inside.
std::vector<std::uint8_t> largest_part(std::span<const std::uint8_t> inside, const GridGeometry& geometry);

/// The voxels where `inside` is not 0 that are face-connected, through such voxels, to the grid's border.
std::vector<std::uint8_t> connected_to_border(std::span<const std::uint8_t> inside, const GridGeometry& geometry);

}  // namespace spinaltap
