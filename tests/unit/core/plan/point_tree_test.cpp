#include "core/plan/point_tree.h"

#include <gtest/gtest.h>

#include "core/base/random.h"

namespace spinaltap {
namespace {

Vec3 random_point(std::uint64_t seed, std::uint64_t n) {
  return {10.0 * random_uniform(seed, 3 * n), 10.0 * random_uniform(seed, 3 * n + 1),
          10.0 * random_uniform(seed, 3 * n + 2)};
}

std::vector<Vec3> random_points(std::size_t count) {
  std::vector<Vec3> points_mm;
  for (std::size_t n = 0; n < count; ++n) points_mm.push_back(random_point(1, n));
  return points_mm;
}

/// The least distance to those points that `takes` takes.
template <class Takes>
double brute_force_mm(const std::vector<Vec3>& points_mm, const Vec3& p_mm, const Takes& takes) {
  double least_mm = std::numeric_limits<double>::infinity();
  for (std::size_t n = 0; n < points_mm.size(); ++n) {
    if (takes(n)) least_mm = std::min(least_mm, (points_mm[n] - p_mm).norm());
  }
  return least_mm;
}

TEST(PointTree, FindsTheNearestWithAnyGuess) {
  const PointTree tree(random_points(2000));
  for (std::uint64_t n = 0; n < 200; ++n) {
    const Vec3 p_mm = 1.4 * random_point(2, n) - Vec3::Constant(2.0);
    const double truth_mm = brute_force_mm(tree.points_mm(), p_mm, [](std::size_t) { return true; });
    EXPECT_NEAR(tree.nearest(p_mm).distance_mm, truth_mm, 1e-12);
    for (const std::size_t guess : {std::size_t{0}, tree.nearest(p_mm).index, std::size_t{1999}}) {
      EXPECT_NEAR(tree.nearest(p_mm, guess).distance_mm, truth_mm, 1e-12);
    }
  }
}

TEST(PointTree, FindsTheNearestOfThoseFlagged) {
  const PointTree tree(random_points(2000));
  // Few flags, and those of a corner: their nearest is often far from the nearest of all.
  std::vector<std::uint8_t> flags;
  for (const Vec3& p_mm : tree.points_mm()) flags.push_back(p_mm.maxCoeff() < 4.0 ? 1 : 0);
  for (std::uint64_t n = 0; n < 200; ++n) {
    const Vec3 p_mm = 1.4 * random_point(3, n) - Vec3::Constant(2.0);
    for (const bool flag : {false, true}) {
      const auto found = tree.nearest_flagged(p_mm, flags, flag);
      EXPECT_EQ(flags[found.index] != 0, flag);
      EXPECT_NEAR(found.distance_mm,
                  brute_force_mm(tree.points_mm(), p_mm, [&](std::size_t i) { return (flags[i] != 0) == flag; }),
                  1e-12);
    }
  }
}

TEST(PointTree, FindsNothingWhereNoneIsFlagged) {
  const PointTree tree(random_points(100));
  const auto none = PointTree(std::vector<Vec3>{}).nearest(Vec3::Zero());
  const auto found = tree.nearest_flagged(Vec3::Zero(), std::vector<std::uint8_t>(100, 0), true);
  EXPECT_EQ(found.distance_mm, none.distance_mm);
}

}  // namespace
}  // namespace spinaltap
