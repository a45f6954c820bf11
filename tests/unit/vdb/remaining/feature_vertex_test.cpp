#include "vdb/remaining/detail/feature_vertex.h"

#include <gtest/gtest.h>

#include <array>

namespace spinaltap::detail {
namespace {

TEST(FeatureVertex, LiesOnAPlane) {
  const Vec3 n = Vec3(1.0, 2.0, 3.0).normalized();
  const Vec3 on(0.4, 0.5, 0.6);
  const Vec3 u = any_perpendicular(n);
  const std::array planes{SurfacePlane{on + 0.2 * u, n}, SurfacePlane{on - 0.1 * u, n},
                          SurfacePlane{on + 0.1 * n.cross(u), n}};
  EXPECT_NEAR((feature_vertex(planes) - on).dot(n), 0.0, 1e-12);
}

TEST(FeatureVertex, LiesOnTheEdgeOfTwoPlanesBesideTheMeanPoint) {
  const std::array planes{SurfacePlane{Vec3(0.3, 0.1, 0.2), Vec3::UnitX()},
                          SurfacePlane{Vec3(0.1, 0.6, 0.4), Vec3::UnitY()}};
  EXPECT_LT((feature_vertex(planes) - Vec3(0.3, 0.6, 0.3)).norm(), 1e-9);
}

TEST(FeatureVertex, LiesInTheCornerOfThreePlanes) {
  const std::array planes{SurfacePlane{Vec3(0.3, 0.1, 0.2), Vec3::UnitX()},
                          SurfacePlane{Vec3(0.1, 0.6, 0.4), Vec3::UnitY()},
                          SurfacePlane{Vec3(0.0, 0.3, 0.7), Vec3(0.0, 0.6, 0.8)}};
  const Vec3 corner(0.3, 0.6, (0.6 * (0.3 - 0.6) + 0.8 * 0.7) / 0.8);
  EXPECT_LT((feature_vertex(planes) - corner).norm(), 1e-9);
}

TEST(FeatureVertex, StaysInItsCell) {
  // Planes that part by 25 degrees and meet 2 cells away.
  const std::array planes{SurfacePlane{Vec3(0.1, 0.5, 0.5), Vec3(-0.2, 1.0, 0.0).normalized()},
                          SurfacePlane{Vec3(0.1, 0.9, 0.5), Vec3(0.2, 1.0, 0.0).normalized()}};
  const Vec3 vertex = feature_vertex(planes);
  EXPECT_GE(vertex.minCoeff(), 0.0);
  EXPECT_LE(vertex.maxCoeff(), 1.0);
}

}  // namespace
}  // namespace spinaltap::detail
