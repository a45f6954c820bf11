#include "core/plan/point_tree.h"

#include <gtest/gtest.h>

#include <limits>

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

double brute_force_mm(const std::vector<Vec3>& points_mm, const Vec3& p_mm) {
  double min_mm = std::numeric_limits<double>::infinity();
  for (const Vec3& point_mm : points_mm) min_mm = std::min(min_mm, (point_mm - p_mm).norm());
  return min_mm;
}

TEST(PointTree, FindsTheNearestWithAnyGuess) {
  const PointTree tree(random_points(2000));
  for (std::uint64_t n = 0; n < 200; ++n) {
    const Vec3 p_mm = 1.4 * random_point(2, n) - Vec3::Constant(2.0);
    const double ground_truth_mm = brute_force_mm(tree.points_mm(), p_mm);
    EXPECT_NEAR(tree.nearest(p_mm).distance_mm, ground_truth_mm, 1e-12);
    for (const std::size_t guess : {std::size_t{0}, tree.nearest(p_mm).index, std::size_t{1999}}) {
      EXPECT_NEAR(tree.nearest(p_mm, guess).distance_mm, ground_truth_mm, 1e-12);
    }
  }
}

}  // namespace
}  // namespace spinaltap
