#include "core/rbf/detail/choose_centres.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "core/base/error.h"
#include "core/rbf/detail/polynomial.h"
#include "tests/unit/core/rbf/point_sets.h"

namespace spinaltap::detail {
namespace {

constexpr std::uint64_t kFirstCentresSeed = 41;

TEST(FirstCentres, AreAHundredthOfThePointsAnd64AtLeast) {
  for (const auto& [points, expected] : {std::pair{10000, 100}, std::pair{6400, 64}, std::pair{300, 64}, {20, 20}}) {
    const std::vector<std::uint32_t> centres =
        first_centres(RadialKernel::biharmonic, test::ball_points(static_cast<std::size_t>(points)));
    EXPECT_EQ(centres.size(), static_cast<std::size_t>(expected)) << points;
    EXPECT_EQ(std::set<std::uint32_t>(centres.begin(), centres.end()).size(), centres.size());
  }
}

TEST(FirstCentres, BeginWithThoseThatDetermineThePolynomial) {
  for (const RadialKernel kernel : {RadialKernel::biharmonic, RadialKernel::triharmonic}) {
    const std::vector<Vec3> points_mm = test::random_points(2000, kFirstCentresSeed);
    const std::vector<std::uint32_t> determining = determining_points(kernel, points_mm);
    const std::vector<std::uint32_t> centres = first_centres(kernel, points_mm);
    EXPECT_TRUE(std::equal(determining.begin(), determining.end(), centres.begin())) << "seed " << kFirstCentresSeed;
  }
}

TEST(FirstCentres, ReachAllOfABall) {
  // 100 caps of equal area on a sphere of 10 mm have a radius of 2 mm; an even spread leaves nothing twice as far off.
  const std::vector<Vec3> points_mm = test::ball_points(10000);
  const std::vector<std::uint32_t> centres = first_centres(RadialKernel::biharmonic, points_mm);
  for (const Vec3& p : points_mm) {
    const auto nearer = [&](std::uint32_t a, std::uint32_t b) {
      return (points_mm[a] - p).squaredNorm() < (points_mm[b] - p).squaredNorm();
    };
    const std::uint32_t nearest = *std::min_element(centres.begin(), centres.end(), nearer);
    ASSERT_LT((points_mm[nearest] - p).norm(), 4.0);
  }
}

TEST(FirstCentres, AreRefusedInAPlane) {
  std::vector<Vec3> points_mm = test::random_points(100, kFirstCentresSeed);
  for (Vec3& p : points_mm) p.z() = 1.0;
  EXPECT_THROW(first_centres(RadialKernel::biharmonic, points_mm), Error);
}

}  // namespace
}  // namespace spinaltap::detail
