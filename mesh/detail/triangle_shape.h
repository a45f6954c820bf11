#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/geometry.h"
#include "core/base/triangle_mesh.h"

namespace spinaltap::detail {

/// Cosine of a triangle's smallest angle: 0.5 when all are equal, 1 when it has no area. Smaller is better.
inline double smallest_angle_cosine(const Vec3& a, const Vec3& b, const Vec3& c) {
  double shortest = (b - c).squaredNorm();
  double other = (c - a).squaredNorm();
  double third = (a - b).squaredNorm();
  if (other < shortest) std::swap(other, shortest);
  if (third < shortest) std::swap(third, shortest);
  const double product = other * third;
  return product > 0.0 ? (other + third - shortest) / (2.0 * std::sqrt(product)) : 1.0;
}

/// The smallest cosine between a triangle's normal and its corners' (unit) normals; -1 for one without area.
inline double agreement(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& normal_a, const Vec3& normal_b,
                        const Vec3& normal_c) {
  const Vec3 normal = (b - a).cross(c - a);
  const double length = normal.norm();
  if (!(length > 0.0)) return -1.0;
  return std::min({normal.dot(normal_a), normal.dot(normal_b), normal.dot(normal_c)}) / length;
}

/// A triangle's normal may differ by 60 degrees from its corners' normals; by more only where it did before.
constexpr double kMinAgreement = 0.5;

/// Square of the distance from p to a triangle, mm².
double squared_distance(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

/// Of each vertex: the sum over its triangles of twice their area along their normal, mm². Indices must be in range.
std::vector<Vec3> area_normals(const TriangleMesh& mesh);

}  // namespace spinaltap::detail
