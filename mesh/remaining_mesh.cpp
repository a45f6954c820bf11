#include "mesh/remaining_mesh.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <vector>

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

LooseChips drop_loose_chips(TriangleMesh& mesh, double max_mm3) {
  constexpr std::uint32_t kNowhere = std::numeric_limits<std::uint32_t>::max();
  // Each vertex points to another of its piece; the first points to itself.
  std::vector<std::uint32_t> first(mesh.vertices_mm.size());
  std::iota(first.begin(), first.end(), 0U);
  const auto piece_of = [&first](std::uint32_t vertex) {
    while (first[vertex] != vertex) vertex = first[vertex] = first[first[vertex]];
    return vertex;
  };
  std::vector<bool> is_used(mesh.vertices_mm.size(), false);
  for (const auto& [a, b, c] : mesh.triangles) {
    is_used[a] = is_used[b] = is_used[c] = true;
    for (const std::uint32_t other : {b, c}) {
      const std::uint32_t one = piece_of(a), two = piece_of(other);
      first[std::max(one, two)] = std::min(one, two);
    }
  }
  std::vector<double> volume_mm3(mesh.vertices_mm.size(), 0.0);
  for (const auto& [a, b, c] : mesh.triangles) {
    const std::uint32_t piece = piece_of(a);
    const Vec3 origin_mm = mesh.vertices_mm[piece].cast<double>();  // far ones would drown what is small
    const auto at = [&](std::uint32_t vertex) -> Vec3 { return mesh.vertices_mm[vertex].cast<double>() - origin_mm; };
    volume_mm3[piece] += at(a).dot(at(b).cross(at(c))) / 6.0;
  }
  if (volume_mm3.empty()) return {};
  const auto largest = std::max_element(volume_mm3.begin(), volume_mm3.end()) - volume_mm3.begin();
  const auto is_chip = [&](std::uint32_t piece) {
    return piece != largest && volume_mm3[piece] >= 0.0 && volume_mm3[piece] <= max_mm3;
  };
  TriangleMesh kept;
  LooseChips chips;
  std::vector<std::uint32_t> moved(mesh.vertices_mm.size(), kNowhere);
  for (std::uint32_t n = 0; n < mesh.vertices_mm.size(); ++n) {
    if (!is_used[n]) continue;
    const std::uint32_t piece = piece_of(n);
    if (!is_chip(piece)) {
      moved[n] = static_cast<std::uint32_t>(kept.vertices_mm.size());
      kept.vertices_mm.push_back(mesh.vertices_mm[n]);
    } else if (piece == n) {
      ++chips.count;
      chips.volume_mm3 += volume_mm3[n];
    }
  }
  if (chips.count == 0) return chips;
  for (const auto& [a, b, c] : mesh.triangles) {
    if (moved[a] != kNowhere) kept.triangles.push_back({moved[a], moved[b], moved[c]});
  }
  mesh = std::move(kept);
  return chips;
}

}  // namespace spinaltap
