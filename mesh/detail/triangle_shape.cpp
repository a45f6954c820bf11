#include "mesh/detail/triangle_shape.h"

namespace spinaltap::detail {

std::vector<Vec3> area_normals(const TriangleMesh& mesh) {
  std::vector<Vec3> normals(mesh.vertices_mm.size(), Vec3::Zero());
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.vertices_mm[t[0]].cast<double>();
    const Vec3 normal = (mesh.vertices_mm[t[1]].cast<double>() - a).cross(mesh.vertices_mm[t[2]].cast<double>() - a);
    for (const std::uint32_t corner : t) normals[corner] += normal;
  }
  return normals;
}

}  // namespace spinaltap::detail
