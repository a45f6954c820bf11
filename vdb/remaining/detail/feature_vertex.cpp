#include "vdb/remaining/detail/feature_vertex.h"

#include <Eigen/Eigenvalues>

#include <algorithm>

namespace spinaltap::detail {

Vec3 feature_vertex(std::span<const SurfacePlane> planes) {
  // Normals within 10 degrees of their mean: a smooth surface, on which only the height matters.
  constexpr double kSmoothCosine = 0.985;
  // Two planes that part by 16 degrees have this ratio of eigenvalues; walls of a 3 mm hole, seen by one cell of
  // 0.2 mm, stay below.
  constexpr double kMinRatio = 0.02;
  Vec3 mean = Vec3::Zero();
  Vec3 normal = Vec3::Zero();
  for (const SurfacePlane& plane : planes) {
    mean += plane.point;
    normal += plane.normal;
  }
  mean /= static_cast<double>(planes.size());
  normal.normalize();
  const bool is_smooth = std::all_of(planes.begin(), planes.end(), [&](const SurfacePlane& plane) {
    return plane.normal.dot(normal) >= kSmoothCosine;
  });
  Vec3 vertex = mean;
  if (is_smooth) {
    double heights = 0.0;
    double weights = 0.0;
    for (const SurfacePlane& plane : planes) {
      const double along = plane.normal.dot(normal);
      heights += along * plane.normal.dot(plane.point - mean);
      weights += along * along;
    }
    vertex += heights / weights * normal;
  } else {
    Mat3 square = Mat3::Zero();
    Vec3 right = Vec3::Zero();
    for (const SurfacePlane& plane : planes) {
      square += plane.normal * plane.normal.transpose();
      right += plane.normal.dot(plane.point - mean) * plane.normal;
    }
    Eigen::SelfAdjointEigenSolver<Mat3> solver;
    solver.computeDirect(square);
    for (Eigen::Index n = 0; n < 3; ++n) {
      const double value = solver.eigenvalues()[n];
      if (!(value > kMinRatio * solver.eigenvalues()[2])) continue;
      const Vec3 direction = solver.eigenvectors().col(n);
      vertex += direction.dot(right) / value * direction;
    }
  }
  return vertex.cwiseMax(0.0).cwiseMin(1.0);
}

}  // namespace spinaltap::detail
