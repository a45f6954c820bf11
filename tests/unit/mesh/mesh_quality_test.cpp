#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/error.h"
#include "mesh/mesh_quality.h"
#include "tests/support/analytic_bodies.h"
#include "tests/support/mesh_shapes.h"
#include "vdb/grid/isosurface.h"

namespace spinaltap {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(MeasureMesh, KnowsATetrahedron) {
  const MeshQuality quality = measure_mesh(test::tetrahedron(6.0F));
  EXPECT_EQ(quality.vertices, 4U);
  EXPECT_EQ(quality.triangles, 4U);
  EXPECT_EQ(quality.pieces, 1U);
  EXPECT_EQ(quality.euler_number, 2);
  EXPECT_TRUE(quality.closed());
  EXPECT_DOUBLE_EQ(quality.volume_mm3, 36.0);
  EXPECT_NEAR(quality.area_mm2, 3.0 * 18.0 + 18.0 * std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(quality.smallest_angle_deg, 45.0, 1e-12);
  EXPECT_EQ(quality.bounds_mm.max(), Vec3(6.0, 6.0, 6.0));
}

TEST(MeasureMesh, KnowsABoxFarFromTheOrigin) {
  const MeshQuality quality = measure_mesh(test::box_mesh({4.0F, 8.0F, 16.0F}, {1024.0F, -512.0F, 2048.0F}));
  EXPECT_TRUE(quality.closed());
  EXPECT_EQ(quality.euler_number, 2);
  // These numbers are exact in floats; sums of products of thousands lose 1e-6 of a double.
  EXPECT_NEAR(quality.volume_mm3, 512.0, 1e-5);
  EXPECT_DOUBLE_EQ(quality.area_mm2, 2.0 * (32.0 + 64.0 + 128.0));
  EXPECT_NEAR(quality.smallest_angle_deg, std::atan(0.25) * 180.0 / std::numbers::pi, 1e-9);
}

TEST(MeasureMesh, HasANegativeVolumeWhenFacesWindInward) {
  TriangleMesh mesh = test::box_mesh({1.0F, 2.0F, 3.0F}, {0.0F, 0.0F, 0.0F});
  for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  const MeshQuality quality = measure_mesh(mesh);
  EXPECT_NEAR(quality.volume_mm3, -6.0, 1e-12);
  EXPECT_TRUE(quality.closed());
}

TEST(MeasureMesh, KnowsTheHoleOfATorus) {
  const MeshQuality quality = measure_mesh(test::torus_mesh(10.0, 3.0, 96, 48));
  EXPECT_TRUE(quality.closed());
  EXPECT_EQ(quality.euler_number, 0);
  EXPECT_EQ(quality.pieces, 1U);
  // Inscribed polygons of 48 and 96 sides lose 2 pi²/3 n² of area: 0.3 and 0.1%.
  const double volume_mm3 = 2.0 * std::numbers::pi * std::numbers::pi * 10.0 * 9.0;
  EXPECT_NEAR(quality.volume_mm3, volume_mm3, 0.006 * volume_mm3);
}

TEST(MeasureMesh, CountsPiecesAndTheirEulerNumbers) {
  TriangleMesh two = test::tetrahedron();
  const TriangleMesh other = test::box_mesh({1.0F, 1.0F, 1.0F}, {50.0F, 0.0F, 0.0F});
  const auto first = static_cast<std::uint32_t>(two.vertices_mm.size());
  two.vertices_mm.insert(two.vertices_mm.end(), other.vertices_mm.begin(), other.vertices_mm.end());
  for (const auto& t : other.triangles) two.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  const MeshQuality quality = measure_mesh(two);
  EXPECT_EQ(quality.pieces, 2U);
  EXPECT_EQ(quality.euler_number, 4);
  EXPECT_TRUE(quality.closed());
  EXPECT_NEAR(quality.volume_mm3, 37.0, 1e-9);
}

TEST(MeasureMesh, CountsTheBorderOfAnOpenMesh) {
  TriangleMesh open = test::box_mesh({1.0F, 1.0F, 1.0F}, {0.0F, 0.0F, 0.0F});
  open.triangles.pop_back();
  MeshQuality quality = measure_mesh(open);
  EXPECT_EQ(quality.boundary_edges, 3U);
  EXPECT_EQ(quality.euler_number, 1);
  EXPECT_FALSE(quality.closed());
  open.triangles.pop_back();
  EXPECT_EQ(measure_mesh(open).boundary_edges, 4U);
}

TEST(MeasureMesh, RejectsAFaceOnAnEdgeThatHasTwo) {
  TriangleMesh fin = test::tetrahedron();
  fin.vertices_mm.emplace_back(-1.0F, -1.0F, 3.0F);
  fin.triangles.push_back({0, 1, 4});
  const MeshQuality quality = measure_mesh(fin);
  EXPECT_EQ(quality.rejected_faces, 1U);
  EXPECT_FALSE(quality.closed());
}

TEST(MeasureMesh, RejectsFacesThatMeetInAVertexOnly) {
  // Two tetrahedra tip to tip: each is closed, the tip is no surface.
  TriangleMesh mesh = test::tetrahedron();
  mesh.vertices_mm.insert(mesh.vertices_mm.end(), {{-6.0F, 0.0F, 0.0F}, {0.0F, -6.0F, 0.0F}, {0.0F, 0.0F, -6.0F}});
  mesh.triangles.insert(mesh.triangles.end(), {{0, 4, 5}, {0, 6, 4}, {0, 5, 6}, {4, 6, 5}});
  const MeshQuality quality = measure_mesh(mesh);
  EXPECT_GT(quality.rejected_faces, 0U);
  EXPECT_FALSE(quality.closed());
}

TEST(MeasureMesh, RejectsFacesThatUseAVertexTwice) {
  for (const std::array<std::uint32_t, 3>& corners :
       {std::array<std::uint32_t, 3>{0, 0, 1}, {0, 1, 1}, {1, 0, 1}, {2, 2, 2}}) {
    TriangleMesh mesh = test::tetrahedron();
    mesh.triangles.push_back(corners);
    const MeshQuality quality = measure_mesh(mesh);
    EXPECT_EQ(quality.rejected_faces, 1U);
    EXPECT_FALSE(quality.closed());
    EXPECT_EQ(quality.euler_number, 2);
    EXPECT_EQ(quality.smallest_angle_deg, 0.0);
  }
}

TEST(MeasureMesh, IgnoresVerticesWithoutFacesInTheEulerNumber) {
  TriangleMesh mesh = test::tetrahedron();
  mesh.vertices_mm.emplace_back(9.0F, 9.0F, 9.0F);
  const MeshQuality quality = measure_mesh(mesh);
  EXPECT_EQ(quality.euler_number, 2);
  EXPECT_TRUE(quality.closed());
}

TEST(MeasureMesh, ThrowsOnAnIndexOutOfRange) {
  TriangleMesh mesh = test::tetrahedron();
  mesh.triangles[2][1] = 4;
  EXPECT_THAT([&] { measure_mesh(mesh); }, ThrowsMessage<Error>(HasSubstr("vertex 4 of 4")));
}

TEST(MeasureMesh, KnowsAnglesAndAspectsOfABoxsHalfSquares) {
  const MeshQuality cube = measure_mesh(test::box_mesh({3.0F, 3.0F, 3.0F}, {0.0F, 0.0F, 0.0F}));
  EXPECT_NEAR(cube.largest_angle_deg, 90.0, 1e-9);
  EXPECT_NEAR(cube.sharpest_edge_deg, 90.0, 1e-9);
  EXPECT_EQ(cube.share_below_30_deg, 0.0);
  // Legs of 1: circumradius sqrt(2)/2, inradius 1 - sqrt(2)/2.
  const double aspect = std::sqrt(0.5) / (2.0 - std::sqrt(2.0));
  EXPECT_NEAR(cube.worst_aspect, aspect, 1e-12);
  EXPECT_NEAR(cube.mean_aspect, aspect, 1e-12);
  EXPECT_EQ(measure_mesh(test::box_mesh({1.0F, 4.0F, 4.0F}, {0.0F, 0.0F, 0.0F})).share_below_30_deg, 8.0 / 12.0);
}

TEST(MeasureMesh, OfNothingIsNotClosed) {
  const MeshQuality quality = measure_mesh({});
  EXPECT_FALSE(quality.closed());
  EXPECT_EQ(quality.pieces, 0U);
  EXPECT_EQ(quality.smallest_angle_deg, 0.0);
}

/// A sheet of 20 by 20 mm, its height a formula of x and y.
template <class Height>
TriangleMesh sheet(const Height& height_mm) {
  constexpr int kSteps = 200;
  constexpr double kStepMm = 0.1;
  TriangleMesh mesh;
  for (int j = 0; j <= kSteps; ++j) {
    for (int i = 0; i <= kSteps; ++i) {
      const double x = kStepMm * i;
      const double y = kStepMm * j;
      mesh.vertices_mm.push_back(Vec3(x, y, height_mm(x, y)).cast<float>());
    }
  }
  const auto at = [](int i, int j) { return static_cast<std::uint32_t>(j * (kSteps + 1) + i); };
  for (int j = 0; j < kSteps; ++j) {
    for (int i = 0; i < kSteps; ++i) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

TEST(Roughness, IsNoneOfAPlane) {
  EXPECT_NEAR(roughness_deg(sheet([](double x, double y) { return 0.3 * x - 0.2 * y; })), 0.0, 0.05);
}

TEST(Roughness, OfAnEvenWaveIsTheRootMeanSquareOfItsSlope) {
  // Waves of 0.4 mm fit into the ball five times; their slope is amplitude times wave number times a cosine.
  constexpr double kAmplitudeMm = 0.01;
  const double wave_number = 2.0 * std::numbers::pi / 0.4;
  const double expected_deg = kAmplitudeMm * wave_number / std::numbers::sqrt2 * 180.0 / std::numbers::pi;
  // Four facets a wave: their slope is the sine's chord, sin(pi / 4) / (pi / 4) of it.
  const double chords = std::sin(std::numbers::pi / 4.0) / (std::numbers::pi / 4.0);
  const double found_deg =
      roughness_deg(sheet([&](double x, double) { return kAmplitudeMm * std::sin(wave_number * x); }));
  EXPECT_LT(found_deg, expected_deg);
  EXPECT_GT(found_deg, 0.6 * chords * expected_deg);
}

TEST(Roughness, OfABallIsItsCurvature) {
  // Within a small cap of radius r the normals tilt by distance / R: root mean square r / (sqrt(2) R).
  const test::Ball ball{Vec3(0.0, 0.0, 0.0), 8.0};
  const double expected_deg = 1.0 / (std::numbers::sqrt2 * ball.radius_mm) * 180.0 / std::numbers::pi;
  EXPECT_NEAR(roughness_deg(bone_surface(test::bake_ball(ball))), expected_deg, 0.1 * expected_deg);
}

TEST(Roughness, DoesNotMixTheTwoSidesOfAPlate) {
  const TriangleMesh top = sheet([](double, double) { return 0.5; });
  TriangleMesh plate = sheet([](double, double) { return 0.0; });
  for (auto& corners : plate.triangles) std::swap(corners[0], corners[1]);
  const auto offset = static_cast<std::uint32_t>(plate.vertices_mm.size());
  plate.vertices_mm.insert(plate.vertices_mm.end(), top.vertices_mm.begin(), top.vertices_mm.end());
  for (const auto& corners : top.triangles) {
    plate.triangles.push_back({corners[0] + offset, corners[1] + offset, corners[2] + offset});
  }
  EXPECT_NEAR(roughness_deg(plate), 0.0, 0.05);
}

TEST(Roughness, RejectsWhatHasNone) {
  EXPECT_THROW(roughness_deg({}), Error);
  EXPECT_THROW(roughness_deg(test::tetrahedron(), 0.0), Error);
  EXPECT_THROW(roughness_deg(test::tetrahedron(), std::numeric_limits<double>::quiet_NaN()), Error);
}

}  // namespace

}  // namespace spinaltap
