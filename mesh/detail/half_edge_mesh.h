#pragma once

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>

#include "core/base/triangle_mesh.h"

namespace spinaltap::detail {

using HalfEdgeMesh = OpenMesh::TriMesh_ArrayKernelT<>;

/// Keeps OpenMesh from writing to the output and error streams; what goes wrong is counted or thrown instead.
class SilencedOutput {
 public:
  SilencedOutput();
  ~SilencedOutput();
  SilencedOutput(const SilencedOutput&) = delete;
  SilencedOutput& operator=(const SilencedOutput&) = delete;

 private:
  bool errors_were_on_;  ///< scopes nest
  bool log_was_on_;
};

struct HalfEdgeResult {
  HalfEdgeMesh mesh;
  std::size_t rejected_faces = 0;  ///< faces that would have made the mesh non-manifold, or use a vertex twice
};

/// OpenMesh's half-edge structure of a mesh. Vertices keep their order. Throws Error when an index is out of range.
HalfEdgeResult to_half_edges(const TriangleMesh& mesh);

}  // namespace spinaltap::detail
