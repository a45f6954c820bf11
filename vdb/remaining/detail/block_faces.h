#pragma once

#include <memory>

#include "vdb/remaining/detail/block_cells.h"
#include "vdb/remaining/surface_block.h"

namespace spinaltap::detail {

/// The cells of a block (the last) and of its seven neighbours on the low sides: number n is that below along x where
/// bit 0 of n is not set, along y bit 1, along z bit 2. Null where there is no surface.
using CellsAround = std::array<const BlockCells*, 8>;

/// A face for each cut edge that begins in the block, between the vertices of the four cells around the edge; two
/// triangles. Null where there is none.
std::shared_ptr<const SurfaceBlock> make_faces(const BlockLattice& lattice, std::size_t block,
                                               const CellsAround& cells);

}  // namespace spinaltap::detail
