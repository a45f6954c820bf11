#pragma once

#include "core/base/triangle_mesh.h"
#include "vdb/grid/bone_model.h"

namespace spinaltap {

struct IsosurfaceOptions {
  /// 0: one vertex for each cell that the surface cuts; up to 1: flat regions get larger triangles.
  double adaptivity = 0.0;
};

/// The bone's surface as triangles, outward, patient LPS mm (OpenVDB's dual contouring of the distance grid).
TriangleMesh bone_surface(const BoneModel& bone, const IsosurfaceOptions& options = {});

}  // namespace spinaltap
