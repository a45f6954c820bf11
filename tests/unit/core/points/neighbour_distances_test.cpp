#include "core/points/neighbour_distances.h"

#include <gtest/gtest.h>

namespace spinaltap {
namespace {

constexpr double kLatticeMm = 0.1;

PointVolume volume(DiscSubdivision subdivision, double jitter = 0.0) {
  const DrillPath path{"", Vec3(31, 212, -618), Vec3(31, 214, -617), {}};
  return {path, {.radius_mm = 2.0, .spacing_mm = kLatticeMm, .subdivision = subdivision, .jitter = jitter}};
}

TEST(NeighbourDistances, AreAllTheSameWithinHexagons) {
  const NeighbourDistances found = neighbour_distances(volume(DiscSubdivision::hexagons), true);
  EXPECT_EQ(found.points, 3U * 18U * 17U + 1U);  // 20 rings but the outermost two
  EXPECT_NEAR(found.min_mm, kLatticeMm, 1e-12);
  EXPECT_NEAR(found.max_mm, kLatticeMm, 1e-12);
  EXPECT_NEAR(found.deviation_mm, 0.0, 1e-7);
}

TEST(NeighbourDistances, LieBetweenRingsApartAndStepsAroundARing) {
  const NeighbourDistances found = neighbour_distances(volume(DiscSubdivision::rings), true);
  // No point of another ring is nearer than the rings are apart; the next on the ring is at most 2 pi / 6 spacings
  // away.
  EXPECT_NEAR(found.min_mm, kLatticeMm, 1e-12);
  EXPECT_LE(found.max_mm, 1.0472 * kLatticeMm);
  EXPECT_GT(found.deviation_mm, 0.0);
}

TEST(NeighbourDistances, AreNoLongerThanDiscsAreApart) {
  const NeighbourDistances found = neighbour_distances(volume(DiscSubdivision::rings), false);
  EXPECT_NEAR(found.max_mm, kLatticeMm, 1e-12);
  EXPECT_NEAR(found.mean_mm, kLatticeMm, 1e-12);
}

TEST(NeighbourDistances, SpreadWithJitter) {
  const NeighbourDistances little = neighbour_distances(volume(DiscSubdivision::rings, 0.1), false);
  const NeighbourDistances much = neighbour_distances(volume(DiscSubdivision::rings, 0.4), false);
  EXPECT_GT(little.deviation_mm, 0.02 * kLatticeMm);
  EXPECT_GT(much.deviation_mm, 2.0 * little.deviation_mm);
  EXPECT_LT(much.mean_mm, little.mean_mm);
}

}  // namespace
}  // namespace spinaltap
