#include "mesh/roughness.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/error.h"
#include "tests/support/analytic_bodies.h"
#include "tests/support/mesh_shapes.h"
#include "vdb/grid/isosurface.h"

namespace spinaltap {
namespace {

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

TEST(Roughness, RefusesWhatHasNone) {
  EXPECT_THROW(roughness_deg({}), Error);
  EXPECT_THROW(roughness_deg(test::tetrahedron(), 0.0), Error);
  EXPECT_THROW(roughness_deg(test::tetrahedron(), std::numeric_limits<double>::quiet_NaN()), Error);
}

}  // namespace
}  // namespace spinaltap
