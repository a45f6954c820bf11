#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "core/base/error.h"
#include "core/rbf/detail/choose_centres.h"
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

TEST(FirstCentres, AreRejectedInAPlane) {
  std::vector<Vec3> points_mm = test::random_points(100, kFirstCentresSeed);
  for (Vec3& p : points_mm) p.z() = 1.0;
  EXPECT_THROW(first_centres(RadialKernel::biharmonic, points_mm), Error);
}

constexpr std::uint64_t kSpreadSeed = 37;

TEST(SpreadWorst, TakesTheWorstAndNoneNearAWorseOne) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSpreadSeed);
  const std::vector<Vec3> points_mm = test::random_points(800, kSpreadSeed);
  std::vector<std::uint32_t> out(800);
  std::iota(out.rbegin(), out.rend(), 0U);
  constexpr std::size_t kCentres = 400;
  const std::vector<std::uint32_t> chosen = spread_worst(points_mm, out, kCentres);
  ASSERT_FALSE(chosen.empty());
  EXPECT_EQ(chosen.front(), 799U);
  EXPECT_LE(chosen.size(), kCentres / 2);
  EXPECT_TRUE(std::is_sorted(chosen.rbegin(), chosen.rend()));
  // Centres on the faces of a cube of 20 mm would have 6 mm^2 each: 2.4 mm apart, 0.7 of which is kept.
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) EXPECT_GT((points_mm[chosen[i]] - points_mm[chosen[j]]).norm(), 1.6);
  }
}

TEST(SpreadWorst, TakesFiftyWhenCentresAreFew) {
  std::vector<Vec3> points_mm;
  for (int i = 0; i < 200; ++i) points_mm.emplace_back(100.0 * i, i % 2, i % 3);
  std::vector<std::uint32_t> out(200);
  std::iota(out.begin(), out.end(), 0U);
  EXPECT_EQ(spread_worst(points_mm, out, 4).size(), 50U);
  EXPECT_EQ(spread_worst(points_mm, out, 150).size(), 75U);
  EXPECT_TRUE(spread_worst(points_mm, {}, 150).empty());
}

TEST(Pick, TakesTheChosenInTheirOrder) {
  const std::vector<double> all{1.0, 2.0, 3.0, 4.0};
  EXPECT_EQ(pick(std::span<const double>(all), {3, 0, 0}), (std::vector<double>{4.0, 1.0, 1.0}));
}

}  // namespace

}  // namespace spinaltap::detail
