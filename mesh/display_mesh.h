#pragma once

#include "core/base/progress.h"
#include "core/base/triangle_mesh.h"
#include "mesh/remesh.h"
#include "vdb/grid/bone_model.h"

namespace spinaltap {

struct DisplayMeshOptions {
  double max_error_mm = 0.05;        ///< between mesh and surface, both ways
  double smallest_angle_deg = 15.0;  ///< of every triangle
  double shortest_edge_voxels = 0.5;
  double longest_edge_voxels = 20.0;
};

/// A bone's surface to show and to print: closed, outward, triangles near to equilateral and as large as the error
/// allows. The isosurface (bone_surface()), meshed anew (remesh()); errors and report are remesh()'s.
///
/// Of a drilled bone: sharp at the hole's rim (sharp_surface()) and decimated (decimate()), so that `max_error_mm` is
/// kept but angles may be half of what is asked.
TriangleMesh display_mesh(const BoneModel& bone, const DisplayMeshOptions& options = {}, RemeshReport* report = nullptr,
                          const Progress& progress = {});

}  // namespace spinaltap
