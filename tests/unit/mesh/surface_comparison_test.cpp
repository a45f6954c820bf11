#include "mesh/surface_comparison.h"

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "tests/support/analytic_bodies.h"
#include "tests/support/mesh_shapes.h"

namespace spinaltap {
namespace {

using test::Ball;

TEST(SurfaceError, IsTheDifferenceOfTwoRadii) {
  const Ball ball{Vec3(1.0, 2.0, 3.0), 10.0};
  const TriangleMesh larger = test::ball_mesh(10.1, ball.centre_mm, 30, 40);
  const SurfaceError outside = surface_error(larger, ball.field());
  // The field is no distance: to first order it misses by d² / 2R, 0.0005 mm.
  EXPECT_NEAR(outside.mean_mm, 0.1, 0.001);
  EXPECT_NEAR(outside.p99_mm, 0.1, 0.001);
  EXPECT_NEAR(outside.max_mm, 0.1, 0.001);
  EXPECT_NEAR(outside.bias_mm, 0.1, 0.001);
  const SurfaceError inside = surface_error(test::ball_mesh(9.9, ball.centre_mm, 30, 40), ball.field());
  EXPECT_NEAR(inside.bias_mm, -0.1, 0.001);
  EXPECT_NEAR(inside.mean_mm, 0.1, 0.001);
}

TEST(SurfaceError, TakesNinetyNineOfAHundred) {
  const Ball ball{Vec3::Zero(), 10.0};
  TriangleMesh mesh;
  for (const Vec3& p : ball.surface_points(2.0)) mesh.vertices_mm.push_back(p.cast<float>());
  mesh.vertices_mm.resize(201);
  // One of 201 is no 1%, three are.
  mesh.vertices_mm[50] *= 1.05F;
  EXPECT_LT(surface_error(mesh, ball.field()).p99_mm, 1e-4);
  EXPECT_NEAR(surface_error(mesh, ball.field()).max_mm, 0.5, 0.02);
  mesh.vertices_mm[60] *= 1.05F;
  mesh.vertices_mm[70] *= 1.05F;
  EXPECT_NEAR(surface_error(mesh, ball.field()).p99_mm, 0.5, 0.02);
}

TEST(SurfaceError, OfNothingIsRejected) { EXPECT_THROW(surface_error({}, Ball().field()), Error); }

}  // namespace
}  // namespace spinaltap
