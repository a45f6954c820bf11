#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/triangle_mesh.h"

namespace spinaltap::detail {

constexpr std::uint32_t kNoVertex = ~0U;

/// The surface that edges are collapsed on, before any went.
struct FineSurface {
  const TriangleMesh& mesh;
  std::vector<float> tolerance_mm;  ///< of each vertex: how far it may lie from what is left when it has gone
  double crease_share = 1.0;        ///< of its tolerance: how far a vertex on a crease may lie from the crease
};

/// A vertex on edges where the surface turns.
struct CreaseVertex {
  enum class Kind : std::uint8_t { smooth, along, end };
  Kind kind = Kind::smooth;  ///< along: it has two such edges; end: one, or more than two
  /// Of the two edges of one `along`: the other ends, as numbers of the fine surface, and the first vertex that went
  /// from there.
  std::array<std::uint32_t, 2> ends{kNoVertex, kNoVertex};
  std::array<std::uint32_t, 2> passed{kNoVertex, kNoVertex};
};

/// A surface, or a part of one with a border, between one pass of collapsing edges and the next.
struct CollapsedPart {
  std::vector<std::uint32_t> originals;  ///< of each vertex: its number in the fine surface, ascending
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<CreaseVertex> creases;  ///< of each vertex
  std::vector<std::uint32_t> passed;  ///< of each triangle: the first of the vertices that went and lie near it
};

/// Chains of vertices that went: of each vertex of the fine surface the next of its chain. A vertex is in one chain of
/// a triangle at most, and in one of a crease, so that parts that share no triangle can be worked on side by side.
struct PassedVertices {
  std::vector<std::uint32_t> next_of_triangle;
  std::vector<std::uint32_t> next_on_crease;

  explicit PassedVertices(std::size_t vertices)
      : next_of_triangle(vertices, kNoVertex), next_on_crease(vertices, kNoVertex) {}
};

/// Of each vertex: the creases that it is on. An edge is one where the normals of its triangles differ by more than
/// 0.5 rad; chains of such edges that are not longer than `shortest_mm` are none: what noise and thin triangles make.
std::vector<CreaseVertex> find_creases(const TriangleMesh& mesh, double shortest_mm);

}  // namespace spinaltap::detail
