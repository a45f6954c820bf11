#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/ct/grid_geometry.h"

namespace spinaltap {

/// Squared distance (mm²) from each voxel's centre to the nearest centre of a voxel where `target` is not 0; infinity
/// when there is none. Exact, in linear time (Felzenszwalb & Huttenlocher 2012).
std::vector<float> squared_distance_to(std::span<const std::uint8_t> target, const GridGeometry& geometry);

/// The same up to `reach_mm` (0 or more), infinity beyond; faster where that is a few voxels. Throws Error on other
/// reaches.
std::vector<float> squared_distance_within(std::span<const std::uint8_t> target, const GridGeometry& geometry,
                                           double reach_mm);

}  // namespace spinaltap
