#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/ct/grid_geometry.h"

namespace spinaltap {

/// Squared distance (mm²) from each voxel's centre to the nearest centre of a voxel where `target` is not 0; infinity
/// when there is none. Exact, in linear time (Felzenszwalb & Huttenlocher 2012).
std::vector<float> squared_distance_to(std::span<const std::uint8_t> target, const GridGeometry& geometry);

}  // namespace spinaltap
