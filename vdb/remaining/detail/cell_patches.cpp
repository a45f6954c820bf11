#include "vdb/remaining/detail/cell_patches.h"

#include <algorithm>
#include <cstddef>

namespace spinaltap::detail {
namespace {

/// Corners of a face in turn, and the edges between each and the next.
struct Face {
  std::array<unsigned, 4> corners;
  std::array<unsigned, 4> edges;
};

unsigned edge_between(unsigned a, unsigned b) {
  const unsigned low = std::min(a, b);
  const unsigned axis = (a ^ b) >> 1U;  // bit 1, 2 or 4
  const unsigned x = low & 1U;
  const unsigned y = low >> 1U & 1U;
  const unsigned z = low >> 2U;
  if (axis == 0) return y + 2 * z;
  return axis == 1 ? 4 + x + 2 * z : 8 + x + 2 * y;
}

Face face_of(unsigned index) {
  const unsigned axis = index / 2;
  const unsigned base = (index % 2) << axis;
  const unsigned u = 1U << (axis == 0 ? 1 : 0);
  const unsigned v = 1U << (axis == 2 ? 1 : 2);
  Face face{{base, base | u, base | u | v, base | v}, {}};
  for (unsigned n = 0; n < 4; ++n) face.edges[n] = edge_between(face.corners[n], face.corners[(n + 1) % 4]);
  return face;
}

struct Tables {
  std::array<std::array<CellPatches, 2>, 256> patches;
  std::array<std::uint8_t, 256> looped;
  Tables();
};

CellPatches find_patches(unsigned code, bool joined) {
  std::array<std::uint8_t, 12> root{};
  for (std::uint8_t edge = 0; edge < 12; ++edge) root[edge] = edge;
  const auto find = [&](unsigned edge) {
    while (root[edge] != edge) edge = root[edge];
    return edge;
  };
  const auto join = [&](unsigned a, unsigned b) {
    const unsigned low = std::min(find(a), find(b));
    root[std::max(find(a), find(b))] = static_cast<std::uint8_t>(low);
  };
  std::array<bool, 12> is_cut{};
  for (unsigned index = 0; index < 6; ++index) {
    const Face face = face_of(index);
    const auto is_bone = [&](unsigned n) { return (code >> face.corners[n % 4] & 1U) != 0; };
    std::array<unsigned, 4> cut{};
    unsigned count = 0;
    for (unsigned n = 0; n < 4; ++n) {
      if (is_bone(n) == is_bone(n + 1)) continue;
      cut[count++] = face.edges[n];
      is_cut[face.edges[n]] = true;
    }
    if (count == 2) join(cut[0], cut[1]);
    if (count != 4) continue;
    // The edges on both sides of corner n are n - 1 and n.
    for (unsigned n = 0; n < 4; ++n) {
      if (is_bone(n) != joined) join(face.edges[(n + 3) % 4], face.edges[n]);
    }
  }
  CellPatches patches;
  std::array<std::uint8_t, 12> of_root{};
  of_root.fill(kNoPatch);
  for (unsigned edge = 0; edge < 12; ++edge) {
    patches.of_edge[edge] = kNoPatch;
    if (!is_cut[edge]) continue;
    std::uint8_t& patch = of_root[find(edge)];
    if (patch == kNoPatch) patch = patches.count++;
    patches.of_edge[edge] = patch;
  }
  return patches;
}

Tables::Tables() : patches{}, looped{} {
  for (unsigned code = 0; code < 256; ++code) {
    patches[code] = {find_patches(code, false), find_patches(code, true)};
    looped[code] = kNoFace;
    for (unsigned index = 0; index < 6; ++index) {
      const Face face = face_of(index);
      const auto& of_edge = patches[code][0].of_edge;
      const bool all_cut =
          std::all_of(face.edges.begin(), face.edges.end(), [&](unsigned edge) { return of_edge[edge] != kNoPatch; });
      const bool one_patch = std::all_of(face.edges.begin(), face.edges.end(),
                                         [&](unsigned edge) { return of_edge[edge] == of_edge[face.edges[0]]; });
      if (all_cut && one_patch) looped[code] = static_cast<std::uint8_t>(index);
    }
  }
}

const Tables& tables() {
  static const Tables made;
  return made;
}

}  // namespace

const CellPatches& cell_patches(std::uint8_t code, bool joined) { return tables().patches[code][joined ? 1 : 0]; }

std::uint8_t looped_face(std::uint8_t code) { return tables().looped[code]; }

}  // namespace spinaltap::detail
