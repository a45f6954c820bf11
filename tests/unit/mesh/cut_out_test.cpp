#include "mesh/cut_out.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "core/base/error.h"
#include "core/tool/drill_path.h"
#include "tests/support/drilled_ball.h"

namespace spinaltap {
namespace {

using test::kDrilledBall;

constexpr double kRadiusMm = 2.95;

DrillPath slanting_path() {
  const Vec3 direction = Vec3(0.3, -0.8, 0.5).normalized();
  // Not through the middle: the cut's edge is no circle.
  const Vec3 aside = 3.0 * any_perpendicular(direction);
  const Vec3 entry = kDrilledBall.centre_mm + aside - std::sqrt(81.0 - 9.0) * direction;
  return {"slanting", entry, entry + 10.0 * direction, test::paper_drill()};
}

TEST(CutOutCylinder, LeavesASurfaceWithOneEdgeThatLiesOnTheCylinder) {
  const DrillPath path = slanting_path();
  const TriangleMesh mesh = cut_out_cylinder(test::ball_to_drill(), path, kRadiusMm, 3.0);
  const PathFrame frame(path.entry_mm, path.direction());
  std::map<std::array<std::uint32_t, 2>, int> edges;
  for (const auto& t : mesh.triangles) {
    for (std::size_t c = 0; c < 3; ++c) ++edges[{t[c], t[(c + 1) % 3]}];
  }
  std::map<std::uint32_t, std::uint32_t> next;  // along the edge
  for (const auto& [edge, count] : edges) {
    ASSERT_EQ(count, 1);
    if (edges.contains({edge[1], edge[0]})) continue;
    EXPECT_TRUE(next.emplace(edge[0], edge[1]).second) << "two edges begin at a vertex";
  }
  ASSERT_GT(next.size(), 50U);
  for (const auto& [a, b] : next) {
    const Vec3 p = frame.to_path(mesh.vertices_mm[a].cast<double>());
    ASSERT_NEAR(p.head<2>().norm(), kRadiusMm, 2e-5);  // floats 100 mm from the origin
  }
  // One loop.
  std::size_t steps = 1;
  for (std::uint32_t at = next.begin()->second; at != next.begin()->first && steps <= next.size(); ++steps) {
    at = next.at(at);
  }
  EXPECT_EQ(steps, next.size());
}

TEST(CutOutCylinder, KeepsAllOfTheBonesSurfaceOutsideAndNothingInside) {
  const DrillPath path = slanting_path();
  const TriangleMesh mesh = cut_out_cylinder(test::ball_to_drill(), path, kRadiusMm, 3.0);
  const PathFrame frame(path.entry_mm, path.direction());
  double area_mm2 = 0.0;
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.vertices_mm[t[0]].cast<double>();
    const Vec3 b = mesh.vertices_mm[t[1]].cast<double>();
    const Vec3 c = mesh.vertices_mm[t[2]].cast<double>();
    area_mm2 += 0.5 * (b - a).cross(c - a).norm();
  }
  for (const Eigen::Vector3f& vertex : mesh.vertices_mm) {
    const Vec3 p_mm = vertex.cast<double>();
    ASSERT_NEAR(kDrilledBall.distance_mm(p_mm), 0.0, 0.02);
    const Vec3 p = frame.to_path(p_mm);
    if (p.z() >= path.length_mm()) continue;
    ASSERT_GE(p.head<2>().norm(), kRadiusMm - 2e-5);
  }
  // The cap that the cylinder takes off, by counting directions.
  std::size_t within = 0;
  const std::vector<Vec3> all = kDrilledBall.surface_points(0.05);
  for (const Vec3& p_mm : all) {
    const Vec3 p = frame.to_path(p_mm);
    within += p.z() < path.length_mm() && p.head<2>().norm() < kRadiusMm ? 1U : 0U;
  }
  const double share = 1.0 - static_cast<double>(within) / static_cast<double>(all.size());
  EXPECT_NEAR(area_mm2, share * kDrilledBall.area_mm2(), 0.003 * kDrilledBall.area_mm2());
}

TEST(CutOutCylinder, RejectsWhatIsNoCylinder) {
  EXPECT_THROW(cut_out_cylinder(test::ball_to_drill(), slanting_path(), 0.0, 3.0), Error);
  EXPECT_THROW(cut_out_cylinder(test::ball_to_drill(), slanting_path(), kRadiusMm, -1.0), Error);
}

}  // namespace
}  // namespace spinaltap
