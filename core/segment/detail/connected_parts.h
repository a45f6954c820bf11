#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/ct/grid_geometry.h"

namespace spinaltap {

/// The face-connected parts of the voxels where `inside` is not 0 that hold a voxel where `touched` is not 0: 1 in
/// those parts, 0 elsewhere. Throws Error when the sizes differ.
std::vector<std::uint8_t> parts_that_touch(std::span<const std::uint8_t> inside, std::span<const std::uint8_t> touched,
                                           const GridGeometry& geometry);

/// What joins two voxels to a part: a face that they share, or an edge or corner too.
enum class Neighbours { by_face, by_corner };

/// The number of voxels where `inside` is not 0, of each connected part; largest first.
std::vector<std::size_t> part_sizes(std::span<const std::uint8_t> inside, const GridGeometry& geometry,
                                    Neighbours neighbours = Neighbours::by_face);

/// Of the face-connected parts of the voxels where `inside` is not 0 the largest, the first of several: 1 in it, 0
/// elsewhere. All 0 where `inside` is.
std::vector<std::uint8_t> largest_part(std::span<const std::uint8_t> inside, const GridGeometry& geometry);

/// `inside` and all that a ball of radius `seal_mm` cannot reach from the grid's border without touching it: hollows
/// are filled, also those behind holes narrower than the ball.
std::vector<std::uint8_t> fill_hollows(std::span<const std::uint8_t> inside, const GridGeometry& geometry,
                                       double seal_mm);

}  // namespace spinaltap
