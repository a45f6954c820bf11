#include "mesh/roughness.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/base/error.h"
#include "core/base/point_grid.h"
#include "mesh/detail/triangle_shape.h"

namespace spinaltap {

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
