#pragma once

#include <memory>

#include "core/base/triangle_mesh.h"
#include "core/phantom/solid.h"

namespace spinaltap {

struct MeshSolidOptions {
  double voxel_mm = 0.15;  ///< of the distance grid made from the mesh
  double cortex_mm = 0.8;  ///< thickness of the cortical shell
  double cortex_hu = 1200.0;
  double trabecular_hu = 180.0;
};

/// A closed surface mesh as a body to scan: a cortical shell around an even trabecular core.
/// Throws Error when the mesh is empty or absurdly large for the voxel.
std::unique_ptr<Solid> make_mesh_solid(const TriangleMesh& mesh, const MeshSolidOptions& options = {});

}  // namespace spinaltap
