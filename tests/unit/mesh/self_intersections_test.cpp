#include "mesh/self_intersections.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "tests/support/mesh_shapes.h"

namespace spinaltap {
namespace {

using Pairs = std::vector<std::array<std::uint32_t, 2>>;

TEST(SelfIntersections, AreNoneInABallAndABox) {
  EXPECT_TRUE(self_intersections(test::ball_mesh(5.0, Vec3(100.0, 3.0, -700.0), 40, 60)).empty());
  EXPECT_TRUE(self_intersections(test::box_mesh({1.0F, 2.0F, 3.0F}, {50.0F, 0.0F, 0.0F})).empty());
  EXPECT_TRUE(self_intersections({}).empty());
}

TEST(SelfIntersections, FindATriangleThatPiercesAnother) {
  const TriangleMesh mesh{{{0.0F, 0.0F, 0.0F},
                           {4.0F, 0.0F, 0.0F},
                           {0.0F, 4.0F, 0.0F},
                           {1.0F, 1.0F, -1.0F},
                           {1.0F, 1.0F, 1.0F},
                           {9.0F, 9.0F, 0.0F}},
                          {{0, 1, 2}, {3, 4, 5}}};
  EXPECT_EQ(self_intersections(mesh), (Pairs{{0, 1}}));
  TriangleMesh apart = mesh;
  // The piercing edge beside the long side x + y = 4, by one part in four million.
  for (const std::size_t i : {3U, 4U}) apart.vertices_mm[i].head<2>().setConstant(std::nextafter(2.0F, 3.0F));
  EXPECT_TRUE(self_intersections(apart).empty());
  for (const std::size_t i : {3U, 4U}) apart.vertices_mm[i].head<2>().setConstant(2.0F);
  EXPECT_EQ(self_intersections(apart), (Pairs{{0, 1}})) << "touching counts";
}

TEST(SelfIntersections, FindTrianglesThatShareACornerAndCross) {
  const TriangleMesh mesh{
      {{0.0F, 0.0F, 0.0F}, {4.0F, 0.0F, 0.0F}, {0.0F, 4.0F, 0.0F}, {1.0F, 1.0F, -1.0F}, {1.0F, 1.0F, 1.0F}},
      {{0, 1, 2}, {3, 4, 0}}};
  EXPECT_EQ(self_intersections(mesh), (Pairs{{0, 1}}));
}

TEST(SelfIntersections, FindAFoldOntoANeighbour) {
  const TriangleMesh flat{{{0.0F, 0.0F, 0.0F}, {4.0F, 0.0F, 0.0F}, {0.0F, 4.0F, 0.0F}, {1.0F, -3.0F, 0.0F}},
                          {{0, 1, 2}, {1, 0, 3}}};
  EXPECT_TRUE(self_intersections(flat).empty());
  TriangleMesh folded = flat;
  folded.vertices_mm[3].y() = 3.0F;
  EXPECT_EQ(self_intersections(folded), (Pairs{{0, 1}}));
}

TEST(SelfIntersections, FindWhereTwoBallsCross) {
  TriangleMesh mesh = test::ball_mesh(5.0, Vec3::Zero(), 30, 40);
  const TriangleMesh other = test::ball_mesh(5.0, Vec3(7.0, 0.1, 0.2), 30, 40);
  const auto first = static_cast<std::uint32_t>(mesh.vertices_mm.size());
  const auto first_triangle = static_cast<std::uint32_t>(mesh.triangles.size());
  mesh.vertices_mm.insert(mesh.vertices_mm.end(), other.vertices_mm.begin(), other.vertices_mm.end());
  for (const auto& t : other.triangles) mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  const Pairs pairs = self_intersections(mesh);
  // They meet in a circle of radius sqrt(5² - 3.5²): at least one pair for each longest edge along it.
  EXPECT_GT(pairs.size(), 40U);
  for (const auto& pair : pairs) {
    EXPECT_LT(pair[0], first_triangle);
    EXPECT_GE(pair[1], first_triangle);
  }
}

TEST(SelfIntersections, RejectIndicesOutOfRangeAndPositionsThatAreNoNumbers) {
  TriangleMesh mesh = test::tetrahedron();
  mesh.triangles[0][0] = 4;
  EXPECT_THROW(self_intersections(mesh), Error);
  mesh = test::tetrahedron();
  mesh.vertices_mm[0].x() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(self_intersections(mesh), Error);
}

}  // namespace
}  // namespace spinaltap
