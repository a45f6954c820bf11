#include "mesh/remaining_mesh.h"

#include <algorithm>

#include "core/base/error.h"
#include "vdb/remaining/remaining_bone.h"
#include "vdb/remaining/remaining_surface.h"

namespace spinaltap {
namespace {

/// A vertex of a block, as it is sorted.
struct Keyed {
  std::uint64_t key;
  Eigen::Vector3f p_mm;
};

std::span<const std::array<std::uint16_t, 3>> triangles_of(const SurfaceBlock& block, SurfacePart part) {
  const std::span<const std::array<std::uint16_t, 3>> all(block.triangles);
  return part == SurfacePart::bone ? all.first(block.wall_begin) : all;
}

}  // namespace

TriangleMesh join_blocks(std::span<const std::shared_ptr<const SurfaceBlock>> blocks, SurfacePart part) {
  std::vector<Keyed> all;
  for (const auto& block : blocks) {
    std::vector<bool> is_used(block->keys.size(), false);
    for (const auto& triangle : triangles_of(*block, part)) {
      for (const std::uint16_t corner : triangle) is_used[corner] = true;
    }
    for (std::size_t n = 0; n < is_used.size(); ++n) {
      if (is_used[n]) all.push_back({block->keys[n], block->vertices_mm[n]});
    }
  }
  std::sort(all.begin(), all.end(), [](const Keyed& a, const Keyed& b) { return a.key < b.key; });
  TriangleMesh mesh;
  std::vector<std::uint64_t> keys;
  for (const Keyed& vertex : all) {
    if (!keys.empty() && keys.back() == vertex.key) {
      if (mesh.vertices_mm.back() != vertex.p_mm) fail("joining blocks: they are of different moments of drilling");
      continue;
    }
    keys.push_back(vertex.key);
    mesh.vertices_mm.push_back(vertex.p_mm);
  }
  for (const auto& block : blocks) {
    std::vector<std::uint32_t> index(block->keys.size());
    for (std::size_t n = 0; n < index.size(); ++n) {
      const auto at = std::lower_bound(keys.begin(), keys.end(), block->keys[n]);
      index[n] = static_cast<std::uint32_t>(at - keys.begin());
    }
    for (const auto& [a, b, c] : triangles_of(*block, part)) mesh.triangles.push_back({index[a], index[b], index[c]});
  }
  return mesh;
}

TriangleMesh sharp_surface(const BoneModel& bone) {
  RemainingBone remaining(bone, {.voxel_mm = bone.voxel_mm()});
  return join_blocks(RemainingSurface(remaining).blocks());
}

}  // namespace spinaltap
