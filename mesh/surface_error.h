#pragma once

#include "core/base/scalar_field.h"
#include "core/base/triangle_mesh.h"

namespace spinaltap {

/// How far a mesh's vertices lie from a true surface, mm.
struct SurfaceError {
  double mean_mm = 0.0;  ///< of the absolute distances
  double p99_mm = 0.0;
  double max_mm = 0.0;
  double bias_mm = 0.0;  ///< mean of the signed distances: positive where the mesh lies outside
};

/// Distances by the truth's value over its slope. Throws Error on an empty mesh.
SurfaceError surface_error(const TriangleMesh& mesh, const ScalarField& truth);

}  // namespace spinaltap
