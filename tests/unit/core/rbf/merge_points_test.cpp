#include "core/rbf/merge_points.h"

#include <gtest/gtest.h>

#include "tests/unit/core/rbf/point_sets.h"

namespace spinaltap::detail {
namespace {

using Indices = std::vector<std::uint32_t>;

TEST(MergePoints, TakesPointsToTheFirstOneNearEnough) {
  const std::vector<Vec3> points_mm{Vec3(0, 0, 0),    Vec3(1, 0, 0),    Vec3(0.05, 0, 0),
                                    Vec3(1.05, 0, 0), Vec3(0.12, 0, 0), Vec3(0, 0, 0)};
  // The fifth is near to the third only, which stands for nothing.
  EXPECT_EQ(merge_points(points_mm, 0.1), (Indices{0, 1, 0, 1, 4, 0}));
  EXPECT_EQ(merge_points(points_mm, 10.0), (Indices{0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(merge_points(points_mm, 0.0), (Indices{0, 1, 2, 3, 4, 0}));
}

TEST(MergePoints, LeavesNoTwoThatAreNear) {
  constexpr std::uint64_t kSeed = 7;
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  const std::vector<Vec3> points_mm = test::clustered_points(1500, kSeed);
  for (const double merge_mm : {1e-4, 0.02, 3.0}) {
    const Indices found = merge_points(points_mm, merge_mm);
    for (std::uint32_t i = 0; i < points_mm.size(); ++i) {
      ASSERT_EQ(found[found[i]], found[i]);
      ASSERT_LE((points_mm[i] - points_mm[found[i]]).norm(), merge_mm);
      if (found[i] != i) continue;
      for (std::uint32_t j = 0; j < i; ++j) {
        ASSERT_TRUE(found[j] != j || (points_mm[i] - points_mm[j]).norm() >= merge_mm);
      }
    }
  }
}

TEST(MergePoints, TakesPointsAllAtOnePlaceWhereverItIs) {
  for (const Vec3& place : {Vec3(0, 0, 0), Vec3(1e7, -1e7, 3.0), Vec3(1e-200, 0, 0)}) {
    for (const double merge_mm : {0.0, 1e-3}) {
      EXPECT_EQ(merge_points(std::vector<Vec3>(4, place), merge_mm), (Indices{0, 0, 0, 0}));
    }
  }
}

}  // namespace
}  // namespace spinaltap::detail
