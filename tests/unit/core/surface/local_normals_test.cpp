#include "core/surface/detail/local_normals.h"

#include <gtest/gtest.h>

#include <numbers>

#include "core/base/error.h"

namespace spinaltap {
namespace {

TEST(LocalNormals, AreThoseOfABall) {
  // A Fibonacci lattice of points about 0.5 mm apart on a ball of 10 mm; outward directions only roughly right.
  constexpr int kCount = 5000;
  std::vector<Vec3> points_mm;
  std::vector<Vec3> outward;
  for (int i = 0; i < kCount; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / kCount;
    const double turn = 2.0 * std::numbers::pi * i / std::numbers::phi;
    const double r = std::sqrt(1.0 - z * z);
    const Vec3 direction(r * std::cos(turn), r * std::sin(turn), z);
    points_mm.emplace_back(Vec3(3, -2, 1) + 10.0 * direction);
    outward.emplace_back(3.0 * (direction + 0.4 * Vec3(direction.y(), -direction.x(), 0.0)));
  }
  const std::vector<Vec3> normals = local_normals(points_mm, outward, 1.5);
  for (int i = 0; i < kCount; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const Vec3 ground_truth = (points_mm[at] - Vec3(3, -2, 1)).normalized();
    // Uneven neighbours within 1.5 mm of a ball of 10 mm lean the plane by up to a few degrees.
    EXPECT_GT(normals[at].dot(ground_truth), std::cos(5.0 * std::numbers::pi / 180.0)) << i;
    EXPECT_NEAR(normals[at].norm(), 1.0, 1e-12);
  }
}

TEST(LocalNormals, KeepTheTwoSidesOfAThinPlateApart) {
  std::vector<Vec3> points_mm;
  std::vector<Vec3> outward;
  for (int i = 0; i < 12; ++i) {
    for (int j = 0; j < 12; ++j) {
      for (const double side : {-1.0, 1.0}) {
        points_mm.emplace_back(0.5 * i, 0.5 * j, 0.2 * side);
        outward.emplace_back(0.3, 0.1, side);
      }
    }
  }
  const std::vector<Vec3> normals = local_normals(points_mm, outward, 1.2);
  for (std::size_t i = 0; i < points_mm.size(); ++i) {
    EXPECT_NEAR(normals[i].z(), points_mm[i].z() > 0.0 ? 1.0 : -1.0, 1e-9);
  }
}

TEST(LocalNormals, KeepTheOutwardDirectionWithoutAPlane) {
  const std::vector<Vec3> line{{0, 0, 0}, {0.5, 0, 0}, {1, 0, 0}, {1.5, 0, 0}, {2, 0, 0}, {90, 0, 0}};
  const std::vector<Vec3> outward(line.size(), Vec3(0, 3, 4));
  for (const Vec3& normal : local_normals(line, outward, 5.0)) EXPECT_EQ(normal, Vec3(0, 0.6, 0.8));
}

TEST(LocalNormals, RejectAnotherNumberOfDirections) {
  const std::vector<Vec3> points_mm(3, Vec3::Zero());
  const std::vector<Vec3> outward(2, Vec3::UnitX());
  EXPECT_THROW(local_normals(points_mm, outward, 1.0), Error);
}

}  // namespace
}  // namespace spinaltap
