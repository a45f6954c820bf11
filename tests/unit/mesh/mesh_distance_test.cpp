#include "mesh/mesh_distance.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/analytic_bodies.h"
#include "tests/support/mesh_shapes.h"

namespace spinaltap {
namespace {

TEST(MeshDistance, OfASmallerBallIsTheDifferenceOfTheRadii) {
  const test::Ball ball{Vec3(5.0, 6.0, 7.0), 10.0};
  const TriangleMesh mesh = test::ball_mesh(9.5, ball.centre_mm, 100, 200);
  // Value over slope is right to first order: (r² - R²) / 2 r at r = 9.5 is 0.013 more; chords lie 0.005 deeper.
  const MeshDistance to = mesh_to_surface(mesh, ball.field());
  EXPECT_NEAR(to.mean_mm, 0.5, 0.025);
  EXPECT_NEAR(to.max_mm, 0.5, 0.025);
  const MeshDistance from = surface_to_mesh(ball.surface_points(0.7), mesh);
  EXPECT_NEAR(from.mean_mm, 0.5, 0.01);
  EXPECT_GE(from.max_mm, from.p99_mm);
  EXPECT_NEAR(from.max_mm, 0.5, 0.01);
}

TEST(MeshDistance, ToABoxIsRightBesideFacesEdgesAndCorners) {
  const TriangleMesh box = test::box_mesh({2.0F, 2.0F, 2.0F}, {0.0F, 0.0F, 0.0F});
  const std::vector<Vec3> points_mm{Vec3(1.0, 1.0, 5.0), Vec3(5.0, 6.0, 1.0), Vec3(-1.0, -2.0, -2.0),
                                    Vec3(1.0, 1.0, 1.5)};
  const std::vector<double> distances_mm = detail::point_distances_mm(points_mm, box);
  EXPECT_DOUBLE_EQ(distances_mm[0], 3.0);
  EXPECT_DOUBLE_EQ(distances_mm[1], 5.0);
  EXPECT_DOUBLE_EQ(distances_mm[2], 3.0);
  EXPECT_DOUBLE_EQ(distances_mm[3], 0.5);
}

}  // namespace
}  // namespace spinaltap
