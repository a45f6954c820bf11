#pragma once

#include <memory>
#include <vector>

#include "vdb/remaining/remaining_bone.h"
#include "vdb/remaining/surface_block.h"

namespace spinaltap {

/// The surface of a RemainingBone, in blocks that are meshed again only where something changed. All blocks together
/// are one closed, manifold mesh that winds outward, whatever was drilled, and the same as if all were meshed at once.
///
/// Dual contouring with normals of bone and bit, so that rims are sharp, with a vertex for each piece of surface in a
/// cell, so that the mesh is manifold: docs/remaining-bone.md.
class RemainingSurface {
 public:
  /// Meshes all of the bone, which must outlive the surface. A bone has one surface: that takes note of what changes.
  explicit RemainingSurface(RemainingBone& bone);
  ~RemainingSurface();
  RemainingSurface(RemainingSurface&&) noexcept;
  RemainingSurface& operator=(RemainingSurface&&) noexcept;
  RemainingSurface(const RemainingSurface&) = delete;
  RemainingSurface& operator=(const RemainingSurface&) = delete;

  /// Meshes what drilling, undoing or resetting changed since the last call; returns the blocks that differ from
  /// before, in a fixed order.
  std::vector<SurfaceUpdate> update();

  /// Meshes everything again.
  void rebuild();

  /// All blocks with surface, in a fixed order. What they point to never changes: another thread may draw it.
  std::vector<std::shared_ptr<const SurfaceBlock>> blocks() const;

  /// Of the surface; not what only others still hold.
  std::size_t memory_bytes() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace spinaltap
