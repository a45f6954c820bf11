#include "vdb/grid/mesh_solid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "core/base/random.h"
#include "tests/support/mesh_shapes.h"

namespace spinaltap {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

struct Sample {
  double value_mm = 0.0;
  Vec3 gradient = Vec3::Zero();
};

Sample at(const Solid& solid, const Vec3& p) {
  Sample sample;
  solid.evaluate({&p, 1}, {&sample.value_mm, 1}, {&sample.gradient, 1});
  return sample;
}

/// Compares values and gradients with the ground truth at random points up to 1.8 mm from the surface.
template <class Distance>
void expect_distance(const Solid& solid, double voxel_mm, const Distance& distance_mm) {
  constexpr std::uint64_t kSeed = 31;
  Box3 box = solid.bounds_mm();
  box.extend(box.min() - Vec3::Constant(2.0)).extend(box.max() + Vec3::Constant(2.0));
  int found = 0;
  for (std::uint64_t n = 0; found < 3000; ++n) {
    const Vec3 p =
        box.min() + box.sizes().cwiseProduct(Vec3(random_uniform(kSeed, 3 * n), random_uniform(kSeed, 3 * n + 1),
                                                  random_uniform(kSeed, 3 * n + 2)));
    const double ground_truth_mm = distance_mm(p);
    const Sample sample = at(solid, p);
    if (std::abs(ground_truth_mm) > 1.8) {
      ASSERT_EQ(sample.value_mm < 0.0, ground_truth_mm < 0.0) << "seed " << kSeed << ", p " << p.transpose();
      continue;
    }
    ++found;
    // Where the distance has a crease (edges, medial planes), tri-linear values round it by at most half a voxel.
    ASSERT_NEAR(sample.value_mm, ground_truth_mm, 0.5 * voxel_mm) << "seed " << kSeed << ", p " << p.transpose();
    ASSERT_LE(sample.gradient.norm(), 1.1);
  }
}

TEST(MeshSolid, GivesTheDistanceToACube) {
  const auto solid = make_mesh_solid(test::box_mesh({12.0F, 9.0F, 15.0F}, {-80.3F, 20.2F, 700.7F}));
  const Vec3 half(6.0, 4.5, 7.5);
  const Vec3 centre = Vec3(-80.3, 20.2, 700.7) + half;
  expect_distance(*solid, 0.15, [&](const Vec3& p) {
    const Vec3 q = (p - centre).cwiseAbs() - half;
    return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
  });
  const Box3 box = solid->bounds_mm();
  EXPECT_TRUE(box.isApprox(Box3(centre - half, centre + half), 1e-6));
}

TEST(MeshSolid, GivesTheDistanceToASphereWithSlopeOneAlongItsNormal) {
  const Vec3 centre(3.0, -4.0, 50.0);
  const auto solid = make_mesh_solid(test::ball_mesh(8.0, centre, 120, 240));
  expect_distance(*solid, 0.15, [&](const Vec3& p) { return (p - centre).norm() - 8.0; });
  const Vec3 away = Vec3(1.0, 2.0, -0.7).normalized();
  const Vec3 slope = at(*solid, centre + 8.4 * away).gradient;
  EXPECT_NEAR(slope.norm(), 1.0, 0.02);
  // Facets of 0.2 mm tilt the normal by 0.2 / 8 / 2 rad.
  EXPECT_GT(slope.normalized().dot(away), std::cos(0.05));
}

TEST(MeshSolid, IsDenseInItsShellAndSoftInItsCore) {
  const MeshSolidOptions options;
  const auto solid = make_mesh_solid(test::ball_mesh(8.0, Vec3::Zero(), 60, 120), options);
  EXPECT_EQ(solid->hu(Vec3::Zero(), 0.0, 0.2), options.cortex_hu);
  EXPECT_EQ(solid->hu(Vec3::Zero(), -0.69, 0.2), options.cortex_hu);
  EXPECT_EQ(solid->hu(Vec3::Zero(), -0.91, 0.2), options.trabecular_hu);
  EXPECT_EQ(solid->hu(Vec3::Zero(), -2.5, 0.2), options.trabecular_hu);
  // In the middle of the edge, half of each.
  EXPECT_NEAR(solid->hu(Vec3::Zero(), -options.cortex_mm, 0.2), 0.5 * (options.cortex_hu + options.trabecular_hu),
              1e-9);
}

TEST(MeshSolid, IsTheSameForFacesThatWindInward) {
  TriangleMesh inward = test::box_mesh({6.0F, 6.0F, 6.0F}, {0.0F, 0.0F, 0.0F});
  for (auto& triangle : inward.triangles) std::swap(triangle[0], triangle[1]);
  const auto solid = make_mesh_solid(inward);
  EXPECT_LT(at(*solid, Vec3(3.0, 3.0, 3.0)).value_mm, 0.0);
  EXPECT_GT(at(*solid, Vec3(9.0, 3.0, 3.0)).value_mm, 0.0);
}

TEST(MeshSolid, RejectsMeshesThatCannotBeABody) {
  EXPECT_THAT([] { make_mesh_solid({}); }, ThrowsMessage<Error>(HasSubstr("no triangles")));
  EXPECT_THAT([] { make_mesh_solid(test::tetrahedron(5000.0F)); }, ThrowsMessage<Error>(HasSubstr("units")));
  TriangleMesh not_a_number = test::tetrahedron();
  not_a_number.vertices_mm[2].x() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT([&] { make_mesh_solid(not_a_number); }, ThrowsMessage<Error>(HasSubstr("not a number")));
  TriangleMesh out_of_range = test::tetrahedron();
  out_of_range.triangles[1][2] = 4;
  EXPECT_THAT([&] { make_mesh_solid(out_of_range); }, ThrowsMessage<Error>(HasSubstr("vertex 4 of 4")));
  for (const double voxel_mm : {0.0, -1.0, 3.0, std::nan("")}) {
    EXPECT_THROW(make_mesh_solid(test::tetrahedron(), {.voxel_mm = voxel_mm}), Error) << voxel_mm;
  }
}

}  // namespace
}  // namespace spinaltap
