#include "vdb/grid/isosurface.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "mesh/mesh_quality.h"
#include "tests/support/analytic_bodies.h"

namespace spinaltap {
namespace {

using test::kBall;
using test::kTorus;

template <class Body>
void expect_surface_of(const TriangleMesh& mesh, const Body& body, long euler_number, double tolerance_mm) {
  const MeshQuality quality = measure_mesh(mesh);
  EXPECT_TRUE(quality.closed());
  EXPECT_EQ(quality.pieces, 1U);
  EXPECT_EQ(quality.euler_number, euler_number);
  // Chords cut off voxel² / (R²) or so of a curved body: 0.06% here.
  EXPECT_NEAR(quality.volume_mm3, body.volume_mm3(), 0.005 * body.volume_mm3());
  EXPECT_NEAR(quality.area_mm2, body.area_mm2(), 0.01 * body.area_mm2());
  for (const Eigen::Vector3f& p : mesh.vertices_mm) {
    ASSERT_LE(std::abs(body.distance_mm(p.cast<double>())), tolerance_mm) << p.transpose();
  }
}

TEST(BoneSurface, IsAClosedSphereThatWindsOutward) {
  expect_surface_of(bone_surface(test::bake_ball(kBall)), kBall, 2, 0.025);
}

TEST(BoneSurface, IsATorusWithItsHole) {
  // A dual vertex is the mean of where a cell's edges are cut: voxel² / 8r inside a tube's curve, 0.002 mm, is nothing.
  expect_surface_of(bone_surface(test::bake_torus(kTorus)), kTorus, 0, 0.025);
}

TEST(BoneSurface, HasFewerTrianglesWhereAdaptivityMergesThem) {
  const BoneModel bone = test::bake_ball(kBall);
  const TriangleMesh even = bone_surface(bone);
  const TriangleMesh adapted = bone_surface(bone, {.adaptivity = 0.5});
  EXPECT_LT(adapted.triangles.size(), even.triangles.size() / 2);
  const MeshQuality quality = measure_mesh(adapted);
  EXPECT_TRUE(quality.closed());
  EXPECT_EQ(quality.euler_number, 2);
  // Faces up to a leaf's diagonal across, 2.8 mm, cut 0.1 mm off the ball where they lie: 3% of its volume.
  EXPECT_NEAR(quality.volume_mm3, kBall.volume_mm3(), 0.03 * kBall.volume_mm3());
}

TEST(BoneSurface, IsTheSameAtOneAndTwoThreads) {
  const BoneModel bone = test::bake_ball(kBall);
  const TriangleMesh many = bone_surface(bone);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const TriangleMesh serial = bone_surface(bone);
  EXPECT_EQ(serial.vertices_mm, many.vertices_mm);
  EXPECT_EQ(serial.triangles, many.triangles);
}

TEST(BoneSurface, RejectsAdaptivityOutOfRange) {
  const BoneModel bone = test::bake_ball({Vec3::Zero(), 3.0});
  EXPECT_THROW(bone_surface(bone, {.adaptivity = -0.1}), Error);
  EXPECT_THROW(bone_surface(bone, {.adaptivity = 1.1}), Error);
  EXPECT_THROW(bone_surface(bone, {.adaptivity = std::numeric_limits<double>::quiet_NaN()}), Error);
}

}  // namespace
}  // namespace spinaltap
