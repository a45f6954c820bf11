#include "mesh/mesh_quality.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/base/error.h"
#include "core/base/geometry.h"
#include "core/base/point_grid.h"
#include "mesh/detail/half_edge_mesh.h"
#include "mesh/detail/triangle_shape.h"

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

constexpr double kDegrees = 180.0 / std::numbers::pi;

std::array<double, 3> angles_rad(const Vec3& a, const Vec3& b, const Vec3& c) {
  const auto angle = [](const Vec3& corner, const Vec3& p, const Vec3& q) {
    return angle_between_rad(p - corner, q - corner);
  };
  return {angle(a, b, c), angle(b, c, a), angle(c, a, b)};
}

/// Circumradius over twice the inradius.
double aspect(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double p = (b - c).norm();
  const double q = (c - a).norm();
  const double r = (a - b).norm();
  const double doubled_area = (b - a).cross(c - a).norm();
  if (!(doubled_area > 0.0)) return std::numeric_limits<double>::infinity();
  return p * q * r * (p + q + r) / (4.0 * doubled_area * doubled_area);
}

double sharpest_edge_rad(const detail::HalfEdgeMesh& mesh) {
  const auto normal_of = [&](OpenMesh::HalfedgeHandle h) -> Vec3 {
    const auto point = [&](OpenMesh::VertexHandle v) -> Vec3 {
      const auto& p = mesh.point(v);
      return Eigen::Vector3f(p[0], p[1], p[2]).cast<double>();
    };
    const Vec3 a = point(mesh.from_vertex_handle(h));
    const Vec3 b = point(mesh.to_vertex_handle(h));
    return (b - a).cross(point(mesh.to_vertex_handle(mesh.next_halfedge_handle(h))) - a);
  };
  double sharpest_rad = 0.0;
  for (const auto edge : mesh.edges()) {
    if (edge.is_boundary()) continue;
    const Vec3 n = normal_of(OpenMesh::HalfedgeHandle(mesh.halfedge_handle(edge, 0).idx()));
    const Vec3 m = normal_of(OpenMesh::HalfedgeHandle(mesh.halfedge_handle(edge, 1).idx()));
    sharpest_rad = std::max(sharpest_rad, angle_between_rad(n, m));
  }
  return sharpest_rad;
}

}  // namespace

MeshQuality measure_mesh(const TriangleMesh& mesh) {
  MeshQuality quality;
  quality.vertices = mesh.vertices_mm.size();
  quality.triangles = mesh.triangles.size();
  double smallest_rad = std::numbers::pi;
  double largest_rad = 0.0;
  std::size_t below_30 = 0;
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
    const std::array<double, 3> angles = angles_rad(a, b, c);
    const double smallest_here_rad = *std::min_element(angles.begin(), angles.end());
    smallest_rad = std::min(smallest_rad, smallest_here_rad);
    largest_rad = std::max(largest_rad, *std::max_element(angles.begin(), angles.end()));
    below_30 += smallest_here_rad * kDegrees < 30.0 ? 1U : 0U;
    const double aspect_here = aspect(a, b, c);
    quality.worst_aspect = std::max(quality.worst_aspect, aspect_here);
    quality.mean_aspect += aspect_here;
    for (const Vec3& corner : {a, b, c}) quality.bounds_mm.extend(corner);
  }
  if (!mesh.triangles.empty()) {
    const auto count = static_cast<double>(mesh.triangles.size());
    quality.smallest_angle_deg = smallest_rad * kDegrees;
    quality.largest_angle_deg = largest_rad * kDegrees;
    quality.share_below_30_deg = static_cast<double>(below_30) / count;
    quality.mean_aspect /= count;
  }

  const detail::HalfEdgeResult linked = detail::to_half_edges(mesh);
  quality.rejected_faces = linked.rejected_faces;
  quality.pieces = count_pieces(linked.mesh);
  quality.sharpest_edge_deg = sharpest_edge_rad(linked.mesh) * kDegrees;
  for (const auto edge : linked.mesh.edges()) quality.boundary_edges += edge.is_boundary() ? 1U : 0U;
  const auto isolated = std::count_if(linked.mesh.vertices_begin(), linked.mesh.vertices_end(),
                                      [&](OpenMesh::VertexHandle handle) { return linked.mesh.is_isolated(handle); });
  quality.euler_number = static_cast<long>(linked.mesh.n_vertices()) - static_cast<long>(isolated) -
                         static_cast<long>(linked.mesh.n_edges()) + static_cast<long>(linked.mesh.n_faces());
  return quality;
}

double roughness_deg(const TriangleMesh& mesh, double radius_mm) {
  if (mesh.triangles.empty()) fail("roughness: the mesh has no triangles");
  if (!(radius_mm > 0.0)) fail("roughness: expected a radius above 0 mm, found ", radius_mm);
  const std::size_t count = mesh.vertices_mm.size();
  std::vector<Vec3> places_mm;
  places_mm.reserve(count);
  for (const Eigen::Vector3f& vertex : mesh.vertices_mm) places_mm.push_back(vertex.cast<double>());
  for (const auto& corners : mesh.triangles) {
    for (const std::uint32_t corner : corners) {
      if (corner >= count) fail("roughness: vertex ", corner, " of ", count);
    }
  }
  const std::vector<Vec3> area_normals = detail::area_normals(mesh);
  const PointGrid grid(places_mm, radius_mm);
  std::vector<double> square_rad(count, 0.0);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 1024), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      Vec3 sum = Vec3::Zero();
      double area = 0.0;
      grid.for_each_within(places_mm[i], radius_mm, [&](std::size_t j) {
        if (!(area_normals[i].dot(area_normals[j]) > 0.0)) return;
        sum += area_normals[j];
        area += area_normals[j].norm();
      });
      // For small angles a to the mean direction, |sum| is the mean of cos(a), 1 - a² / 2.
      if (area > 0.0) square_rad[i] = std::max(0.0, 2.0 * (1.0 - sum.norm() / area));
    }
  });
  double spread_rad = 0.0;
  double area = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    spread_rad += area_normals[i].norm() * std::sqrt(square_rad[i]);
    area += area_normals[i].norm();
  }
  return area > 0.0 ? spread_rad / area * 180.0 / std::numbers::pi : 0.0;
}

}  // namespace spinaltap
