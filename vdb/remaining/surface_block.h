#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <span>
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

  /// Of all that it holds.
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

/// Hands blocks of a surface from the thread that drills to one that draws. Of each block only the latest waits, so
/// memory is bounded by the surface however slowly is drawn; blocks are shared and never change, so nobody waits while
/// they are drawn. Both sides hold the lock for as long as it takes to move some pointers.
class SurfaceFeed {
 public:
  /// From the thread that drills: each takes the place of what waits of its block.
  void give(std::span<const SurfaceUpdate> updates) {
    const std::lock_guard lock(mutex_);
    for (const SurfaceUpdate& update : updates) waiting_[update.block] = update;
  }

  /// What was given since the last call, in a fixed order.
  std::vector<SurfaceUpdate> take() {
    std::map<std::array<int, 3>, SurfaceUpdate> taken;
    {
      const std::lock_guard lock(mutex_);
      taken.swap(waiting_);
    }
    std::vector<SurfaceUpdate> updates;
    updates.reserve(taken.size());
    for (auto& [block, update] : taken) updates.push_back(std::move(update));
    return updates;
  }

 private:
  std::mutex mutex_;
  std::map<std::array<int, 3>, SurfaceUpdate> waiting_;
};

}  // namespace spinaltap
