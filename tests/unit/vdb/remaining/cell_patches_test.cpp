#include "vdb/remaining/detail/cell_patches.h"

#include <gtest/gtest.h>

#include <bit>
#include <set>

namespace spinaltap::detail {
namespace {

/// Edges of face 2 a + s: those whose corner lies at s along a.
std::vector<unsigned> edges_of_face(unsigned face) {
  std::vector<unsigned> edges;
  const unsigned across = face / 2;
  for (unsigned edge = 0; edge < 12; ++edge) {
    const unsigned axis = edge / 4;
    if (axis == across) continue;
    const unsigned first_other = axis == 0 ? 1 : 0;
    const unsigned at = across == first_other ? edge % 2 : edge / 2 % 2;
    if (at == face % 2) edges.push_back(edge);
  }
  return edges;
}

TEST(CellPatches, CutTheEdgesWhoseEndsDiffer) {
  for (unsigned code = 0; code < 256; ++code) {
    for (unsigned edge = 0; edge < 12; ++edge) {
      const unsigned axis = edge / 4;
      const unsigned u = edge % 2;
      const unsigned v = edge / 2 % 2;
      const unsigned first = axis == 0 ? u << 1U | v << 2U : (axis == 1 ? u | v << 2U : u | v << 1U);
      const bool differ = (code >> first & 1U) != (code >> (first | 1U << axis) & 1U);
      for (const bool joined : {false, true}) {
        const CellPatches& patches = cell_patches(static_cast<std::uint8_t>(code), joined);
        ASSERT_EQ(patches.of_edge[edge] != kNoPatch, differ);
        if (differ) {
          ASSERT_LT(patches.of_edge[edge], patches.count);
        }
        ASSERT_LE(patches.count, 4);
      }
    }
  }
}

TEST(CellPatches, NeverLetTwoLinesOfAFaceBeLoopedOnBothSides) {
  // Cells that meet at a face share its four corners. Whatever the others are, one of them must have two pieces there.
  std::size_t looped = 0;
  for (unsigned axis = 0; axis < 3; ++axis) {
    const unsigned high_face = 2 * axis + 1;
    const unsigned low_face = 2 * axis;
    const unsigned step = 1U << axis;
    for (unsigned low_code = 0; low_code < 256; ++low_code) {
      for (unsigned high_code = 0; high_code < 256; ++high_code) {
        bool same = true;
        for (unsigned corner = 0; corner < 8; ++corner) {
          if ((corner & step) != 0) continue;
          same = same && (low_code >> (corner | step) & 1U) == (high_code >> corner & 1U);
        }
        if (!same) continue;
        const auto a = static_cast<std::uint8_t>(low_code);
        const auto b = static_cast<std::uint8_t>(high_code);
        const bool joined = looped_face(a) == high_face && looped_face(b) == low_face;
        looped += joined ? 1 : 0;
        const auto pieces = [](const CellPatches& patches, unsigned face) {
          std::set<unsigned> found;
          unsigned cut = 0;
          for (const unsigned edge : edges_of_face(face)) {
            if (patches.of_edge[edge] == kNoPatch) continue;
            found.insert(patches.of_edge[edge]);
            ++cut;
          }
          return cut == 4 ? found.size() : 2;
        };
        // Joined there, a cell is not joined anywhere else: it has no other such face.
        const std::size_t on_low = pieces(cell_patches(a, joined), high_face);
        const std::size_t on_high = pieces(cell_patches(b, joined), low_face);
        ASSERT_GT(on_low + on_high, 2U) << low_code << " " << high_code;
      }
    }
  }
  EXPECT_GT(looped, 0U);
}

TEST(CellPatches, AreJoinedOnlyWhereOneFaceIsAmbiguous) {
  for (unsigned code = 0; code < 256; ++code) {
    if (looped_face(static_cast<std::uint8_t>(code)) == kNoFace) continue;
    std::size_t ambiguous = 0;
    for (unsigned face = 0; face < 6; ++face) {
      std::size_t cut = 0;
      for (const unsigned edge : edges_of_face(face)) {
        cut += cell_patches(static_cast<std::uint8_t>(code), false).of_edge[edge] != kNoPatch ? 1U : 0U;
      }
      ambiguous += cut == 4 ? 1U : 0U;
    }
    EXPECT_EQ(ambiguous, 1U) << code;
  }
}

}  // namespace
}  // namespace spinaltap::detail
