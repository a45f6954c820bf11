#include "core/surface/detail/local_normals.h"

#include <tbb/parallel_for.h>

#include <Eigen/Eigenvalues>

#include "core/base/error.h"
#include "core/base/point_grid.h"

namespace spinaltap {

std::vector<Vec3> local_normals(std::span<const Vec3> points_mm, std::span<const Vec3> outward, double radius_mm) {
  constexpr int kFewest = 3;
  constexpr double kFlat = 0.5;  // of the least spread over the middle one
  if (outward.size() != points_mm.size()) fail("normals: expected one outward direction a point");
  const PointGrid grid(points_mm, radius_mm);
  std::vector<Vec3> normals(points_mm.size());
  tbb::parallel_for(std::size_t{0}, points_mm.size(), [&](std::size_t i) {
    const Vec3& p_mm = points_mm[i];
    Vec3 sum = Vec3::Zero();
    Mat3 squares = Mat3::Zero();
    int count = 0;
    grid.for_each_within(p_mm, radius_mm, [&](std::size_t near) {
      if (outward[near].dot(outward[i]) < 0.0) return;
      const Vec3 way = points_mm[near] - p_mm;
      sum += way;
      squares += way * way.transpose();
      ++count;
    });
    normals[i] = outward[i].normalized();
    if (count <= kFewest) return;
    const Eigen::SelfAdjointEigenSolver<Mat3> spread(squares - sum * sum.transpose() / count);
    if (!(spread.eigenvalues()[0] < kFlat * spread.eigenvalues()[1])) return;
    const Vec3 normal = spread.eigenvectors().col(0).normalized();
    normals[i] = normal.dot(outward[i]) < 0.0 ? Vec3(-normal) : normal;
  });
  return normals;
}

}  // namespace spinaltap
