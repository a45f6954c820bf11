#pragma once

#include <openvdb/openvdb.h>

#include <cstddef>

namespace spinaltap::detail {

/// Keeps the largest solid of a level set (negative inside; values near the surface, background elsewhere), without its
/// cavities; returns how many solids and cavities went. Where they touched the band of what stays, the band may be one
/// voxel wide on each side of the surface.
std::size_t keep_one_piece(openvdb::FloatGrid::Ptr& grid);

}  // namespace spinaltap::detail
