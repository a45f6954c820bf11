#pragma once

#include <cstdint>
#include <vector>

#include "core/base/triangle_mesh.h"

namespace spinaltap::detail {

/// A surface, or a part of one with a border, between one pass of collapsing edges and the next.
struct CollapsedMesh {
  TriangleMesh mesh;
  std::vector<std::uint32_t> originals;                 ///< of each vertex: its number in the first mesh
  std::vector<std::vector<Eigen::Vector3f>> passed_mm;  ///< of each triangle: vertices that went, and lie near it
};

struct CollapseOptions {
  double tolerance_mm = 0.04;         ///< of vertices that go, to the triangles that are left
  double crease_tolerance_mm = 0.04;  ///< of those on a crease, to the crease that is left
};

/// Collapses edges, those that change least first, while all that has gone stays within the tolerances. Vertices of the
/// border stay, as do those that `is_kept`. Must run within a SilencedOutput. Gives nothing where the surface is not
/// manifold.
bool collapse_edges(CollapsedMesh& surface, const std::vector<std::uint8_t>& is_kept, const CollapseOptions& options);

}  // namespace spinaltap::detail
