#include "core/segment/star_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/error.h"
#include "core/base/random.h"

namespace spinaltap {
namespace {

/// The radius of a ball of `radius_mm` around `centre_mm`, seen from the origin.
double ball_radius_mm(const Vec3& direction, const Vec3& centre_mm, double radius_mm) {
  const double along = direction.dot(centre_mm);
  return along + std::sqrt(along * along + radius_mm * radius_mm - centre_mm.squaredNorm());
}

TEST(StarSurface, KnowsVolumeAndDepthOfABall) {
  StarSurface surface(Vec3::Zero(), 2000);
  const Vec3 centre_mm(3.0, -2.0, 4.0);
  for (std::size_t i = 0; i < surface.directions().size(); ++i) {
    surface.radii_mm()[i] = ball_radius_mm(surface.directions()[i], centre_mm, 15.0);
  }
  const double volume_mm3 = 4.0 / 3.0 * std::numbers::pi * 15.0 * 15.0 * 15.0;
  EXPECT_NEAR(surface.volume_mm3(), volume_mm3, 0.002 * volume_mm3);
  // Radii are averaged over a few degrees: less than 0.1 mm on this ball.
  for (const Vec3& direction : {Vec3(1, 0, 0), Vec3(0, 0, -1), Vec3(0.6, 0.0, 0.8)}) {
    const double radius_mm = ball_radius_mm(direction, centre_mm, 15.0);
    EXPECT_NEAR(surface.depth_mm(7.0 * direction), radius_mm - 7.0, 0.1);
    EXPECT_LT(surface.depth_mm((radius_mm + 1.0) * direction), 0.0);
  }
}

TEST(StarSurface, HasAboutSixNeighboursInEachDirectionAndTheyAreMutual) {
  const StarSurface surface(Vec3::Zero(), 800);
  for (std::size_t i = 0; i < surface.neighbours().size(); ++i) {
    EXPECT_GE(surface.neighbours()[i].size(), 4U);
    EXPECT_LE(surface.neighbours()[i].size(), 10U);
    for (const int j : surface.neighbours()[i]) {
      const auto& back = surface.neighbours()[static_cast<std::size_t>(j)];
      EXPECT_NE(std::find(back.begin(), back.end(), static_cast<int>(i)), back.end());
    }
  }
}

TEST(StarSurface, RejectsTooFewDirections) { EXPECT_THROW(StarSurface(Vec3::Zero(), 10), Error); }

TEST(ChooseSteps, TakesTheCheapestWithoutStiffness) {
  const StarSurface surface(Vec3::Zero(), 200);
  const auto cheapest = [](int direction) { return direction % 7; };
  StarCost cost;
  cost.step_count = 9;
  cost.stiffness = 0.0;
  cost.cost = [&](int direction, int step) { return step == cheapest(direction) ? 0.0 : 1.0; };
  const std::vector<int> steps = choose_steps(surface, cost);
  for (int i = 0; i < 200; ++i) EXPECT_EQ(steps[static_cast<std::size_t>(i)], cheapest(i));
}

TEST(ChooseSteps, PullsRaysThatNoiseLedAstrayBackToTheirNeighbours) {
  constexpr std::uint64_t kSeed = 5;
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  const StarSurface surface(Vec3::Zero(), 800);
  constexpr int kTrue = 6;
  StarCost cost;
  cost.step_count = 20;
  cost.stiffness = 0.2;
  // One ray in five prefers a step anywhere to the true one.
  cost.cost = [&](int direction, int step) {
    const auto n = static_cast<std::uint64_t>(direction);
    const int stray = static_cast<int>(20.0 * random_uniform(kSeed, 2 * n));
    if (random_uniform(kSeed, 2 * n + 1) < 0.2 && step == stray) return -1.2;
    return step == kTrue ? -1.0 : 0.0;
  };
  for (const int step : choose_steps(surface, cost)) EXPECT_EQ(step, kTrue);
}

}  // namespace
}  // namespace spinaltap
