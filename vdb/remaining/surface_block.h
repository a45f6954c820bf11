#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/geometry.h"

namespace spinaltap {

/// The surface in one block of 8 x 8 x 8 cells of a RemainingBone, complete in itself: what a renderer keeps in one
/// buffer. Positions that blocks share are the same in all of them, bit for bit.
struct SurfaceBlock {
  std::array<int, 3> block{};  ///< its first voxel is 8 times this
  /// Patient LPS. On a rim between bone and wall there are two vertices in one place, each with its side's normal.
  std::vector<Eigen::Vector3f> vertices_mm;
  std::vector<Eigen::Vector3f> normals;  ///< unit, outward
  /// Vertices with the same key, in any blocks, are one vertex of the closed mesh.
  std::vector<std::uint64_t> keys;
  /// Indices into vertices_mm, outward; up to `wall_begin` of the bone's own surface, from there on of drilled walls.
  std::vector<std::array<std::uint16_t, 3>> triangles;
  std::size_t wall_begin = 0;

  std::size_t memory_bytes() const {
    return sizeof(*this) + vertices_mm.capacity() * sizeof(vertices_mm[0]) + normals.capacity() * sizeof(normals[0]) +
           keys.capacity() * sizeof(keys[0]) + triangles.capacity() * sizeof(triangles[0]);
  }
  bool operator==(const SurfaceBlock&) const = default;
};

/// A block that is no longer as it was.
struct SurfaceUpdate {
  std::array<int, 3> block{};
  std::shared_ptr<const SurfaceBlock> surface;  ///< null where no surface is left
};

}  // namespace spinaltap
