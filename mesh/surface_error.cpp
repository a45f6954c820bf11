#include "mesh/surface_error.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/error.h"

namespace spinaltap {

SurfaceError surface_error(const TriangleMesh& mesh, const ScalarField& truth) {
  if (mesh.vertices_mm.empty()) fail("comparing surfaces: the mesh is empty");
  std::vector<Vec3> points_mm;
  for (const Eigen::Vector3f& p : mesh.vertices_mm) points_mm.push_back(p.cast<double>());
  std::vector<double> distance_mm(points_mm.size());
  std::vector<Vec3> gradients(points_mm.size());
  truth.evaluate(points_mm, distance_mm, gradients);
  SurfaceError error;
  for (std::size_t i = 0; i < distance_mm.size(); ++i) {
    // Far from the surface a truth may be flat; its value is then the least that the distance can be.
    const double slope = gradients[i].norm();
    if (slope > 0.5) distance_mm[i] /= slope;
    error.bias_mm += distance_mm[i];
    distance_mm[i] = std::abs(distance_mm[i]);
    error.mean_mm += distance_mm[i];
  }
  const auto count = static_cast<double>(distance_mm.size());
  error.bias_mm /= count;
  error.mean_mm /= count;
  std::sort(distance_mm.begin(), distance_mm.end());
  error.p99_mm = distance_mm[(distance_mm.size() - 1) * 99 / 100];
  error.max_mm = distance_mm.back();
  return error;
}

}  // namespace spinaltap
