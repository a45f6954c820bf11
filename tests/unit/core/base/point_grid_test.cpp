#include "core/base/point_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "core/base/error.h"
#include "core/base/random.h"

namespace spinaltap {
namespace {

constexpr std::uint64_t kPointGridSeed = 99;

/// Points in a box of 20 x 10 x 2 mm far from the origin; every tenth is given twice.
std::vector<Vec3> cloud(std::size_t count) {
  std::vector<Vec3> points_mm;
  for (std::uint64_t n = 0; points_mm.size() < count; ++n) {
    const Vec3 p(random_uniform(kPointGridSeed, 3 * n), random_uniform(kPointGridSeed, 3 * n + 1),
                 random_uniform(kPointGridSeed, 3 * n + 2));
    points_mm.push_back(Vec3(500, -900, 100) + p.cwiseProduct(Vec3(20, 10, 2)));
    if (n % 10 == 0) points_mm.push_back(points_mm.back());
  }
  return points_mm;
}

TEST(PointGrid, FindsWhatALookAtEveryPointFinds) {
  SCOPED_TRACE(::testing::Message() << "seed " << kPointGridSeed);
  const std::vector<Vec3> points_mm = cloud(600);
  for (const double cell_mm : {0.01, 0.7, 5.0, 100.0}) {
    const PointGrid grid(points_mm, cell_mm);
    for (std::uint64_t n = 0; n < 100; ++n) {
      Vec3 p = Vec3(500, -900, 100) - Vec3(2, 2, 2);
      for (int axis = 0; axis < 3; ++axis)
        p[axis] += 24.0 * random_uniform(kPointGridSeed + 1, 3 * n + static_cast<unsigned>(axis));
      if (n % 4 == 0) p = points_mm[5 * n];
      const double radius_mm = 4.0 * random_uniform(kPointGridSeed + 2, n);
      std::vector<std::size_t> found, expected;
      grid.for_each_within(p, radius_mm, [&](std::size_t i) { found.push_back(i); });
      PointGrid::Nearest nearest;
      for (std::size_t i = 0; i < points_mm.size(); ++i) {
        const double distance_mm = (points_mm[i] - p).norm();
        if ((points_mm[i] - p).squaredNorm() > radius_mm * radius_mm) continue;
        expected.push_back(i);
        if (distance_mm < nearest.distance_mm) nearest = {i, distance_mm};
      }
      std::sort(found.begin(), found.end());
      ASSERT_EQ(found, expected);
      ASSERT_EQ(grid.nearest_within(p, radius_mm).index, nearest.index);
      ASSERT_EQ(grid.nearest_within(p, radius_mm).distance_mm, nearest.distance_mm);
    }
  }
}

TEST(PointGrid, FindsNothingAroundAPlaceThatIsNone) {
  const std::vector<Vec3> points_mm = cloud(50);
  const PointGrid grid(points_mm, 1.0);
  EXPECT_FALSE(
      std::isfinite(grid.nearest_within(Vec3(0, std::numeric_limits<double>::quiet_NaN(), 0), 1e3).distance_mm));
  const PointGrid empty({}, 1.0);
  EXPECT_FALSE(std::isfinite(empty.nearest_within(Vec3::Zero(), 1e3).distance_mm));
}

TEST(PointGrid, RejectsPointsAndCellsThatAreNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<Vec3> points_mm = cloud(50);
  EXPECT_THROW(PointGrid(points_mm, 0.0), Error);
  EXPECT_THROW(PointGrid(points_mm, nan), Error);
  points_mm[7].z() = nan;
  EXPECT_THROW(PointGrid(points_mm, 1.0), Error);
}

TEST(SpreadSubset, KeepsItsSpacingAndCoversEveryPoint) {
  SCOPED_TRACE(::testing::Message() << "seed " << kPointGridSeed);
  const std::vector<Vec3> points_mm = cloud(1500);
  const std::vector<Vec3> normals(points_mm.size(), Vec3::UnitX());
  for (const double spacing_mm : {1e-6, 0.3, 1.0, 4.0, 100.0}) {
    const std::vector<std::size_t> kept = spread_subset(points_mm, normals, spacing_mm);
    EXPECT_TRUE(std::is_sorted(kept.begin(), kept.end()));
    for (std::size_t a = 0; a < kept.size(); ++a) {
      for (std::size_t b = 0; b < a; ++b) ASSERT_GT((points_mm[kept[a]] - points_mm[kept[b]]).norm(), spacing_mm);
    }
    for (const Vec3& p : points_mm) {
      ASSERT_TRUE(std::any_of(kept.begin(), kept.end(),
                              [&](std::size_t i) { return (points_mm[i] - p).norm() <= spacing_mm; }));
    }
  }
}

TEST(SpreadSubset, KeepsBothSidesOfAThinPlate) {
  std::vector<Vec3> points_mm;
  std::vector<Vec3> normals;
  for (int i = 0; i < 20; ++i) {
    for (const double side : {1.0, -1.0}) {
      points_mm.emplace_back(0.6 * i, 0.0, side * 0.05);
      normals.emplace_back(0.0, 0.0, side);
    }
  }
  EXPECT_EQ(spread_subset(points_mm, normals, 0.5).size(), points_mm.size());
  EXPECT_EQ(spread_subset(points_mm, normals, 1.0).size(), points_mm.size() / 2);
}

}  // namespace
}  // namespace spinaltap
