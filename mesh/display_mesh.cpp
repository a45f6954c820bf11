#include "mesh/display_mesh.h"

#include "mesh/decimate.h"
#include "mesh/remaining_mesh.h"
#include "vdb/grid/bone_field.h"
#include "vdb/grid/bone_model.h"
#include "vdb/grid/isosurface.h"

namespace spinaltap {

TriangleMesh display_mesh(const BoneModel& bone, const DisplayMeshOptions& options, RemeshReport* report,
                          const Progress& progress) {
  // Remeshing would round a hole's rim off.
  if (is_drilled(bone)) return decimate(sharp_surface(bone), options.max_error_mm, report, progress);
  const double voxel_mm = bone.voxel_mm();
  const RemeshOptions remesh_options{.max_error_mm = options.max_error_mm,
                                     .smallest_angle_deg = options.smallest_angle_deg,
                                     .shortest_edge_mm = options.shortest_edge_voxels * voxel_mm,
                                     .longest_edge_mm = options.longest_edge_voxels * voxel_mm};
  return remesh(bone_surface(bone), BoneField(bone), remesh_options, report, progress);
}

}  // namespace spinaltap
