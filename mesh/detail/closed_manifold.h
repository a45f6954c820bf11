#pragma once

#include "core/base/triangle_mesh.h"

namespace spinaltap::detail {

/// Whether a mesh has triangles, all with three corners that are vertices of it, with another on each of their sides
/// that winds the same way, and around each vertex in one ring.
bool is_closed_manifold(const TriangleMesh& mesh);

}  // namespace spinaltap::detail
