#include "mesh/mesh_quality.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/base/error.h"
#include "mesh/detail/half_edge_mesh.h"

namespace spinaltap {
namespace {

std::size_t count_pieces(const detail::HalfEdgeMesh& mesh) {
  std::vector<bool> seen(mesh.n_faces(), false);
  std::vector<OpenMesh::FaceHandle> open;
  std::size_t pieces = 0;
  for (const auto start : mesh.faces()) {
    if (seen[static_cast<std::size_t>(start.idx())]) continue;
    ++pieces;
    seen[static_cast<std::size_t>(start.idx())] = true;
    open.assign(1, start);
    while (!open.empty()) {
      const OpenMesh::FaceHandle face = open.back();
      open.pop_back();
      for (auto next = mesh.cff_iter(face); next.is_valid(); ++next) {
        const auto index = static_cast<std::size_t>(next->idx());
        if (!seen[index]) {
          seen[index] = true;
          open.push_back(*next);
        }
      }
    }
  }
  return pieces;
}

double smallest_angle_rad(const Vec3& a, const Vec3& b, const Vec3& c) {
  const auto angle = [](const Vec3& corner, const Vec3& p, const Vec3& q) {
    return std::atan2((p - corner).cross(q - corner).norm(), (p - corner).dot(q - corner));
  };
  return std::min({angle(a, b, c), angle(b, c, a), angle(c, a, b)});
}

}  // namespace

MeshQuality measure_mesh(const TriangleMesh& mesh) {
  MeshQuality quality;
  quality.vertices = mesh.vertices_mm.size();
  quality.triangles = mesh.triangles.size();
  double smallest_rad = std::numbers::pi;
  const auto vertex = [&](std::uint32_t index) -> Vec3 {
    if (index >= mesh.vertices_mm.size()) fail("mesh: vertex ", index, " of ", mesh.vertices_mm.size());
    return mesh.vertices_mm[index].cast<double>();
  };
  for (const auto& corners : mesh.triangles) {
    const Vec3 a = vertex(corners[0]);
    const Vec3 b = vertex(corners[1]);
    const Vec3 c = vertex(corners[2]);
    quality.area_mm2 += 0.5 * (b - a).cross(c - a).norm();
    quality.volume_mm3 += a.dot(b.cross(c)) / 6.0;
    smallest_rad = std::min(smallest_rad, smallest_angle_rad(a, b, c));
    for (const Vec3& corner : {a, b, c}) quality.bounds_mm.extend(corner);
  }
  quality.smallest_angle_deg = mesh.triangles.empty() ? 0.0 : smallest_rad * 180.0 / std::numbers::pi;

  const detail::HalfEdgeResult linked = detail::to_half_edges(mesh);
  quality.refused_faces = linked.refused_faces;
  quality.pieces = count_pieces(linked.mesh);
  for (const auto edge : linked.mesh.edges()) quality.boundary_edges += edge.is_boundary() ? 1U : 0U;
  const auto isolated = std::count_if(linked.mesh.vertices_begin(), linked.mesh.vertices_end(),
                                      [&](OpenMesh::VertexHandle handle) { return linked.mesh.is_isolated(handle); });
  quality.euler_number = static_cast<long>(linked.mesh.n_vertices()) - static_cast<long>(isolated) -
                         static_cast<long>(linked.mesh.n_edges()) + static_cast<long>(linked.mesh.n_faces());
  return quality;
}

}  // namespace spinaltap
