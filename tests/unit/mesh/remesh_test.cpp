// Compiled with optimisation: long loops of its own.

#include "mesh/remesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/error.h"
#include "mesh/mesh_quality.h"
#include "mesh/self_intersections.h"
#include "tests/support/analytic_bodies.h"
#include "tests/support/mesh_shapes.h"
#include "tests/support/test_kind.h"
#include "vdb/grid/isosurface.h"

namespace spinaltap {
namespace {

using test::Ball;
using test::FormulaField;
using test::Torus;
using testing::HasSubstr;
using testing::ThrowsMessage;

/// Distance to a body by formula, with its gradient by central differences.
FormulaField distance_field(const FormulaField::Value& distance_mm) {
  return {distance_mm, [distance_mm](const Vec3& p) -> Vec3 {
            constexpr double kStepMm = 1e-5;
            Vec3 gradient;
            for (Eigen::Index axis = 0; axis < 3; ++axis) {
              const Vec3 step = kStepMm * Vec3::Unit(axis);
              gradient[axis] = (distance_mm(p + step) - distance_mm(p - step)) / (2.0 * kStepMm);
            }
            return gradient;
          }};
}

/// Farthest of many places on the triangles from a surface.
double farthest_mm(const TriangleMesh& mesh, const FormulaField::Value& distance_mm) {
  constexpr int kParts = 6;
  double farthest = 0.0;
  for (const auto& t : mesh.triangles) {
    for (int i = 0; i <= kParts; ++i) {
      for (int j = 0; i + j <= kParts; ++j) {
        const Eigen::Vector3f p =
            (static_cast<float>(i) * mesh.vertices_mm[t[0]] + static_cast<float>(j) * mesh.vertices_mm[t[1]] +
             static_cast<float>(kParts - i - j) * mesh.vertices_mm[t[2]]) /
            static_cast<float>(kParts);
        farthest = std::max(farthest, std::abs(distance_mm(p.cast<double>())));
      }
    }
  }
  return farthest;
}

/// What every mesh must be. The check between its own sample places may miss a little of the bound: a tenth.
void expect_good(const TriangleMesh& mesh, const RemeshReport& report, const FormulaField::Value& distance_mm,
                 double max_error_mm, long euler_number) {
  EXPECT_TRUE(report.reached);
  const MeshQuality quality = measure_mesh(mesh);
  EXPECT_TRUE(quality.closed());
  EXPECT_EQ(quality.euler_number, euler_number);
  EXPECT_GE(quality.smallest_angle_deg, 15.0);
  EXPECT_NEAR(report.smallest_angle_deg, quality.smallest_angle_deg, 1e-6);
  EXPECT_TRUE(self_intersections(mesh).empty());
  EXPECT_LE(farthest_mm(mesh, distance_mm), 1.1 * max_error_mm);
  EXPECT_LE(report.to_surface.max_mm, max_error_mm);
  EXPECT_LE(report.from_surface.max_mm, max_error_mm);
}

SLOW_TESTS("Remesh.IsTheSameAtOneAndTwoThreads", "Remesh.HasFewerTrianglesWhereMoreErrorIsAllowed",
           "Remesh.KeepsTheHoleOfATorus");

TEST(Remesh, GivesSpheresOfAnySizeWithinTheError) {
  for (const double radius_mm : {0.8, 4.0, 20.0}) {
    const Ball ball{Vec3(30.0, -20.0, 700.0), radius_mm};
    const TriangleMesh start = test::ball_mesh(radius_mm, ball.centre_mm, 60, 120);
    RemeshReport report;
    const TriangleMesh mesh = remesh(start, ball.field(), {}, &report);
    expect_good(
        mesh, report, [&](const Vec3& p) { return ball.distance_mm(p); }, 0.05, 2);
    // Vertices lie on the sphere, the rest within it: the volume lacks at most the area times the error.
    const MeshQuality quality = measure_mesh(mesh);
    EXPECT_LE(quality.volume_mm3, ball.volume_mm3() * 1.0001);
    EXPECT_GE(quality.volume_mm3, ball.volume_mm3() - 0.05 * ball.area_mm2());
    EXPECT_LE(quality.area_mm2, ball.area_mm2() * 1.0001);
    // Few: an equilateral triangle of edge L has an area of L² sqrt(3) / 4, where L² = 6 e R; half as long is enough.
    const double largest_mm2 = 6.0 * 0.05 * radius_mm * std::sqrt(3.0) / 4.0;
    EXPECT_LE(static_cast<double>(quality.triangles), 5.0 * ball.area_mm2() / largest_mm2);
  }
}

TEST(Remesh, KeepsTheHoleOfATorus) {
  const Torus torus{Vec3(-4.2, 1.7, -60.3), 12.0, 4.0};
  TriangleMesh start = test::torus_mesh(12.0, 4.0, 200, 80);
  for (Eigen::Vector3f& p : start.vertices_mm) p += torus.centre_mm.cast<float>();
  RemeshReport report;
  const TriangleMesh mesh = remesh(start, torus.field(), {}, &report);
  expect_good(
      mesh, report, [&](const Vec3& p) { return torus.distance_mm(p); }, 0.05, 0);
  EXPECT_NEAR(measure_mesh(mesh).volume_mm3, torus.volume_mm3(), 0.05 * torus.area_mm2());
}

TEST(Remesh, HasFewerTrianglesWhereMoreErrorIsAllowed) {
  const Ball ball{Vec3::Zero(), 10.0};
  const TriangleMesh start = test::ball_mesh(10.0, Vec3::Zero(), 80, 160);
  std::size_t last = std::numeric_limits<std::size_t>::max();
  for (const double error_mm : {0.02, 0.05, 0.2, 0.5}) {
    RemeshReport report;
    const TriangleMesh mesh = remesh(start, ball.field(), {.max_error_mm = error_mm}, &report);
    expect_good(
        mesh, report, [&](const Vec3& p) { return ball.distance_mm(p); }, error_mm, 2);
    // Triangles go with one over the error.
    EXPECT_LT(2 * mesh.triangles.size(), last);
    last = mesh.triangles.size() + mesh.triangles.size() / 4;
  }
}

TEST(Remesh, IsFinerWhereTheSurfaceIsCurved) {
  // A plate 16 x 16 x 1.6 mm, round at its rim: flat faces, and curves of 0.8 mm.
  const auto distance_mm = [](const Vec3& p) {
    const Vec3 q = p.cwiseAbs() - Vec3(7.2, 7.2, 1e-3);
    return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0) - 0.8;
  };
  const FormulaField field = distance_field(distance_mm);
  const std::vector<Vec3> seeds_mm{Vec3(0.0, 0.0, 0.801)};
  const Box3 box(Vec3(-8.0, -8.0, -0.8), Vec3(8.0, 8.0, 0.8));
  const TriangleMesh start = bone_surface(bake_bone(field, seeds_mm, test::even_ct(box, 1.0, 300), {}, {}));
  RemeshReport report;
  const TriangleMesh mesh = remesh(start, field, {}, &report);
  expect_good(mesh, report, distance_mm, 0.05, 2);
  double rim_mm = 0.0;
  double flat_mm = 0.0;
  double at_rim = 0.0;
  double on_flat = 0.0;
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.vertices_mm[t[0]].cast<double>();
    const double edge_mm = (a - mesh.vertices_mm[t[1]].cast<double>()).norm();
    const double across_mm = a.head<2>().cwiseAbs().maxCoeff();
    if (across_mm > 7.5) {
      rim_mm += edge_mm;
      at_rim += 1.0;
    } else if (across_mm < 4.0) {
      flat_mm += edge_mm;
      on_flat += 1.0;
    }
  }
  EXPECT_GT(flat_mm / on_flat, 2.0 * rim_mm / at_rim);
}

TEST(Remesh, KeepsTwoSheetsApartThatAreNearerThanTheError) {
  // A hollow ball with a wall of 0.3 mm.
  const Ball outer{Vec3::Zero(), 6.0};
  const Ball inner{Vec3::Zero(), 5.7};
  TriangleMesh start = test::ball_mesh(6.0, Vec3::Zero(), 60, 120);
  const TriangleMesh hollow = test::ball_mesh(5.7, Vec3::Zero(), 60, 120);
  const auto first = static_cast<std::uint32_t>(start.vertices_mm.size());
  start.vertices_mm.insert(start.vertices_mm.end(), hollow.vertices_mm.begin(), hollow.vertices_mm.end());
  for (const auto& t : hollow.triangles) start.triangles.push_back({t[0] + first, t[2] + first, t[1] + first});
  const auto distance_mm = [&](const Vec3& p) { return std::max(outer.distance_mm(p), -inner.distance_mm(p)); };
  for (const double error_mm : {0.05, 0.4}) {
    RemeshReport report;
    const TriangleMesh mesh = remesh(start, distance_field(distance_mm), {.max_error_mm = error_mm}, &report);
    expect_good(mesh, report, distance_mm, error_mm, 4);
    EXPECT_EQ(measure_mesh(mesh).pieces, 2U);
  }
}

TEST(Remesh, IsTheSameAtOneAndTwoThreads) {
  const Torus torus;
  const TriangleMesh start = test::torus_mesh(12.0, 4.0, 150, 60);
  const TriangleMesh many = remesh(start, torus.field());
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const TriangleMesh serial = remesh(start, torus.field());
  EXPECT_EQ(serial.vertices_mm, many.vertices_mm);
  EXPECT_EQ(serial.triangles, many.triangles);
}

TEST(Remesh, RejectsOptionsThatAreNoNumbers) {
  const Ball ball{Vec3::Zero(), 3.0};
  const TriangleMesh start = test::ball_mesh(3.0, Vec3::Zero(), 10, 20);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const RemeshOptions& options :
       {RemeshOptions{.max_error_mm = 0.0}, RemeshOptions{.max_error_mm = nan},
        RemeshOptions{.smallest_angle_deg = nan}, RemeshOptions{.smallest_angle_deg = 26.0},
        RemeshOptions{.shortest_edge_mm = 0.0}, RemeshOptions{.shortest_edge_mm = nan},
        RemeshOptions{.longest_edge_mm = 0.05}, RemeshOptions{.longest_edge_mm = nan}}) {
    EXPECT_THROW(remesh(start, ball.field(), options), Error);
  }
}

TEST(Remesh, RejectsASurfaceThatIsNotClosedAndSaysWhere) {
  const Ball ball{Vec3::Zero(), 3.0};
  TriangleMesh open = test::ball_mesh(3.0, Vec3::Zero(), 10, 20);
  open.triangles.erase(open.triangles.begin());
  EXPECT_THAT([&] { remesh(open, ball.field()); }, ThrowsMessage<Error>(HasSubstr("found a border at (")));
  TriangleMesh fin = test::ball_mesh(3.0, Vec3::Zero(), 10, 20);
  fin.vertices_mm.emplace_back(5.0F, 5.0F, 5.0F);
  fin.triangles.push_back({0, 1, static_cast<std::uint32_t>(fin.vertices_mm.size() - 1)});
  EXPECT_THAT([&] { remesh(fin, ball.field()); }, ThrowsMessage<Error>(HasSubstr("expected a manifold surface")));
  EXPECT_THROW(remesh({}, ball.field()), Error);
}

TEST(Remesh, StopsWhenCancelled) {
  const Ball ball{Vec3::Zero(), 3.0};
  const TriangleMesh start = test::ball_mesh(3.0, Vec3::Zero(), 10, 20);
  const Progress progress([](std::string_view, double) {});
  progress.cancel();
  EXPECT_THROW(remesh(start, ball.field(), {}, nullptr, progress), Cancelled);
}

}  // namespace
}  // namespace spinaltap
