#pragma once

#include <vector>

#include "core/base/triangle_mesh.h"

namespace spinaltap::detail {

/// Of each vertex: the sum over its triangles of twice their area along their normal, mm². Indices must be in range.
std::vector<Vec3> area_normals(const TriangleMesh& mesh);

}  // namespace spinaltap::detail
