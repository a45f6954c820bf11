#include "mesh/detail/half_edge_mesh.h"

#include <OpenMesh/Core/Utils/vector_cast.hh>

#include "core/base/error.h"

namespace spinaltap::detail {

SilencedOutput::SilencedOutput() : errors_were_on_(omerr().is_enabled()), log_was_on_(omlog().is_enabled()) {
  // Not again within a scope that silences them already, in which other threads may be at work.
  if (errors_were_on_) omerr().disable();
  if (log_was_on_) omlog().disable();
}

SilencedOutput::~SilencedOutput() {
  if (errors_were_on_) omerr().enable();
  if (log_was_on_) omlog().enable();
}

HalfEdgeResult to_half_edges(const TriangleMesh& mesh) {
  const SilencedOutput silenced;
  HalfEdgeResult result;
  result.mesh.reserve(mesh.vertices_mm.size(), mesh.triangles.size() * 3 / 2, mesh.triangles.size());
  for (const Eigen::Vector3f& p : mesh.vertices_mm) result.mesh.add_vertex({p.x(), p.y(), p.z()});
  for (const auto& corners : mesh.triangles) {
    for (const std::uint32_t corner : corners) {
      if (corner >= mesh.vertices_mm.size()) fail("mesh: vertex ", corner, " of ", mesh.vertices_mm.size());
    }
    // OpenMesh asserts that the three differ, and without assertions breaks its lists.
    const bool degenerate = corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0];
    const auto handle = [&](std::size_t corner) { return OpenMesh::VertexHandle(static_cast<int>(corners[corner])); };
    if (degenerate || !result.mesh.add_face(handle(0), handle(1), handle(2)).is_valid()) ++result.rejected_faces;
  }
  return result;
}

}  // namespace spinaltap::detail
