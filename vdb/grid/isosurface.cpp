#include "vdb/grid/isosurface.h"

#include <openvdb/tools/VolumeToMesh.h>

#include "core/base/error.h"
#include "vdb/detail/bone_grids.h"

namespace spinaltap {

TriangleMesh bone_surface(const BoneModel& bone, const IsosurfaceOptions& options) {
  if (!(options.adaptivity >= 0.0 && options.adaptivity <= 1.0)) {
    fail("isosurface: expected adaptivity from 0 to 1, found ", options.adaptivity);
  }
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(*bone.grids().sdf, points, triangles, quads, 0.0, options.adaptivity);
  TriangleMesh mesh;
  mesh.vertices_mm.reserve(points.size());
  for (const openvdb::Vec3s& p : points) mesh.vertices_mm.emplace_back(p.x(), p.y(), p.z());
  mesh.triangles.reserve(triangles.size() + 2 * quads.size());
  // OpenVDB's faces wind inward, so they are turned round here.
  for (const openvdb::Vec3I& t : triangles) mesh.triangles.push_back({t[2], t[1], t[0]});
  for (const openvdb::Vec4I& q : quads) {
    // The shorter diagonal gives the better triangles.
    const auto diagonal = [&](std::uint32_t a, std::uint32_t b) {
      return (mesh.vertices_mm[a] - mesh.vertices_mm[b]).squaredNorm();
    };
    if (diagonal(q[0], q[2]) <= diagonal(q[1], q[3])) {
      mesh.triangles.push_back({q[2], q[1], q[0]});
      mesh.triangles.push_back({q[3], q[2], q[0]});
    } else {
      mesh.triangles.push_back({q[3], q[2], q[1]});
      mesh.triangles.push_back({q[3], q[1], q[0]});
    }
  }
  return mesh;
}

}  // namespace spinaltap
