#include "core/rbf/detail/sparse_grid.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/core/rbf/point_sets.h"

namespace spinaltap::detail {
namespace {

constexpr std::uint64_t kSparseSeed = 83;

std::vector<std::uint32_t> found_within(const SparseGrid& grid, const Vec3& p, double radius_mm) {
  std::vector<std::uint32_t> found;
  EXPECT_FALSE(grid.visit_within(p, radius_mm, [&](std::uint32_t index, double) {
    found.push_back(index);
    return false;
  }));
  return found;
}

TEST(SparseGrid, VisitsThePointsWithinARadiusOnceEach) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSparseSeed);
  const std::vector<Vec3> points_mm = test::clustered_points(600, kSparseSeed);
  for (const double cell_mm : {0.01, 0.7, 50.0}) {
    SparseGrid grid(points_mm, cell_mm, 10);  // more are added than it has room for
    for (std::uint32_t i = 0; i < 600; i += 2) grid.add(i);
    for (std::uint64_t n = 0; n < 60; ++n) {
      const Vec3 p = n < 30 ? points_mm[n] : test::random_place(kSparseSeed + 1, n, 15.0);
      for (const double radius_mm : {0.0, 0.005, 0.3, 4.0, 100.0}) {
        if (radius_mm > 500.0 * cell_mm) continue;
        std::vector<std::uint32_t> found = found_within(grid, p, radius_mm);
        std::sort(found.begin(), found.end());
        std::vector<std::uint32_t> expected;
        for (std::uint32_t i = 0; i < 600; i += 2) {
          if ((points_mm[i] - p).squaredNorm() <= radius_mm * radius_mm) expected.push_back(i);
        }
        ASSERT_EQ(found, expected) << "cell " << cell_mm << " radius " << radius_mm;
      }
    }
  }
}

TEST(SparseGrid, LooksAtItsPointsWhenTheRadiusHoldsMoreCells) {
  const std::vector<Vec3> points_mm{Vec3(0, 0, 0), Vec3(1e-9, 0, 0), Vec3(100, 0, 0)};
  SparseGrid grid(points_mm, 1e-9, 3);
  for (std::uint32_t i = 0; i < 3; ++i) grid.add(i);
  // 1e36 cells.
  EXPECT_EQ(found_within(grid, Vec3(1, 0, 0), 1000.0).size(), 3U);
  EXPECT_EQ(found_within(grid, Vec3(1, 0, 0), 2.0).size(), 2U);
}

TEST(SparseGrid, StopsWhenItIsTold) {
  const std::vector<Vec3> points_mm = test::random_points(50, kSparseSeed);
  SparseGrid grid(points_mm, 3.0, 50);
  for (std::uint32_t i = 0; i < 50; ++i) grid.add(i);
  for (const double radius_mm : {5.0, 1e6}) {
    int visits = 0;
    EXPECT_TRUE(grid.visit_within(points_mm[7], radius_mm, [&](std::uint32_t, double) { return ++visits == 2; }));
    EXPECT_EQ(visits, 2);
  }
}

}  // namespace
}  // namespace spinaltap::detail
