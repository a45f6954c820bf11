#pragma once

#include <array>
#include <cstdint>

namespace spinaltap::detail {

// Cells of 2 x 2 x 2 voxels. Corner c lies at (c & 1, c >> 1 & 1, c >> 2) from the first; a cell's code has bit c where
// corner c is bone. Edge 4 a + u + 2 v runs along axis a from the corner that lies at u and v along the two other axes,
// in the order x, y, z. Face 2 a + s is that across axis a, on the low (s = 0) or high (s = 1) side.

inline constexpr std::uint8_t kNoPatch = 0xFF;
inline constexpr std::uint8_t kNoFace = 0xFF;

/// The pieces of surface in a cell: for each edge that the surface cuts, the piece that it is cut by.
struct CellPatches {
  std::uint8_t count = 0;
  std::array<std::uint8_t, 12> of_edge{};  ///< kNoPatch where the edge is not cut
};

/// Nielson 2004, "Dual marching cubes": one vertex for each piece of surface that marching cubes has in a cell. On a
/// face with bone at two opposite corners only, the surface passes round each of them, so that both are apart; where
/// `joined` is set, round the other two.
const CellPatches& cell_patches(std::uint8_t code, bool joined);

/// The face on which both lines of the surface belong to one piece of a cell, kNoFace where there is none. Where two
/// such cells meet at such a face, one edge of the dual surface would have four faces (Wenger 2013, "Isosurfaces",
/// section 3.3). With the face joined in both, each line has a piece of its own.
std::uint8_t looped_face(std::uint8_t code);

}  // namespace spinaltap::detail
