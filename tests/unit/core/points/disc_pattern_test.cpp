#include "core/points/disc_pattern.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/error.h"

namespace spinaltap {
namespace {

TEST(DiscPattern, HoldsAsManyPointsAsThePaperSays) {
  // The paper's section 6.3: 3n(n-1) + 1 with n = radius / spacing. 378 discs of 2,611 are its 986,958 points.
  EXPECT_EQ(DiscPattern(3.0, 0.1).point_count(), 2611U);
  EXPECT_EQ(378U * DiscPattern(3.0, 0.1).point_count(), 986'958U);
  EXPECT_EQ(DiscPattern(4.0, 0.1).point_count(), 4681U);
  EXPECT_EQ(DiscPattern(4.0, 0.05).point_count(), 18'961U);
  EXPECT_EQ(DiscPattern(0.1, 0.1).point_count(), 1U);
}

TEST(DiscPattern, PutsEachRingOnItsCircle) {
  const DiscPattern pattern(3.0, 0.1);
  std::size_t next = 0;
  for (int ring = 0; ring < pattern.ring_count(); ++ring) {
    ASSERT_EQ(DiscPattern::ring_start(ring), next);
    for (std::size_t i = 0; i < DiscPattern::ring_size(ring); ++i) {
      // cos² + sin² is 1 within a few units of the last place.
      EXPECT_NEAR(pattern.point_mm(next + i).norm(), 0.1 * ring, 1e-15);
    }
    next += DiscPattern::ring_size(ring);
  }
  EXPECT_EQ(next, pattern.point_count());
}

TEST(DiscPattern, SpacesTheNeighboursOfARingNearlyAlike) {
  const DiscPattern pattern(3.0, 0.1);
  const double arc_mm = 0.1 * std::numbers::pi / 3.0;
  for (int ring = 1; ring < pattern.ring_count(); ++ring) {
    const std::size_t start = DiscPattern::ring_start(ring);
    const std::size_t size = DiscPattern::ring_size(ring);
    for (std::size_t i = 0; i < size; ++i) {
      const double chord_mm = (pattern.point_mm(start + i) - pattern.point_mm(start + (i + 1) % size)).norm();
      EXPECT_NEAR(chord_mm, 0.2 * ring * std::sin(std::numbers::pi / (6.0 * ring)), 1e-14);
      // The hexagon's chord is its radius. From ring 2 on the chords are the paper's 0.103 mm and more (section 6.4),
      // and stay below the arc of 0.1047 mm, which they approach.
      if (ring > 1) {
        EXPECT_GT(chord_mm, 0.1035);
      }
      EXPECT_LT(chord_mm, arc_mm);
    }
  }
}

TEST(DiscPattern, SharesTheDiscsVolumeAmongItsPoints) {
  for (const double spacing_mm : {0.2, 0.1, 0.05, 0.025}) {
    const DiscPattern pattern(3.0, spacing_mm);
    double sum_mm3 = 0.0;
    for (int ring = 0; ring < pattern.ring_count(); ++ring) {
      sum_mm3 += static_cast<double>(DiscPattern::ring_size(ring)) * pattern.point_volume_mm3(ring);
    }
    // The outermost ring lies a spacing within the radius and stands for half a spacing beyond itself.
    const double reach_mm = 3.0 - 0.5 * spacing_mm;
    EXPECT_NEAR(sum_mm3, std::numbers::pi * reach_mm * reach_mm * spacing_mm, 1e-12 * sum_mm3) << spacing_mm;
  }
}

TEST(DiscPattern, KnowsTheRingOfEveryPoint) {
  EXPECT_EQ(DiscPattern::ring_of(0), 0);
  // Both ends of each ring, up to the largest disc allowed.
  for (int ring = 1; ring < 4096; ++ring) {
    const std::size_t start = DiscPattern::ring_start(ring);
    ASSERT_EQ(DiscPattern::ring_of(start), ring);
    ASSERT_EQ(DiscPattern::ring_of(start + 3 * static_cast<std::size_t>(ring)), ring);
    ASSERT_EQ(DiscPattern::ring_of(start + DiscPattern::ring_size(ring) - 1), ring);
  }
}

TEST(DiscPattern, PutsHexagonsPointsAtOneDistanceFromTheirNeighbours) {
  const DiscPattern pattern(1.5, 0.1, DiscSubdivision::hexagons);
  EXPECT_EQ(pattern.point_count(), DiscPattern(1.5, 0.1).point_count());
  for (std::size_t i = 0; i < pattern.point_count(); ++i) {
    double nearest_mm = 1e9;
    int neighbours = 0;
    for (std::size_t j = 0; j < pattern.point_count(); ++j) {
      if (i == j) continue;
      const double distance_mm = (pattern.point_mm(i) - pattern.point_mm(j)).norm();
      nearest_mm = std::min(nearest_mm, distance_mm);
      neighbours += std::abs(distance_mm - 0.1) < 1e-12;
    }
    EXPECT_NEAR(nearest_mm, 0.1, 1e-14);
    // Six around each point; four beside those of the outermost hexagon's sides, three at its corners.
    const int ring = DiscPattern::ring_of(i);
    const bool is_outermost = ring == pattern.ring_count() - 1;
    const bool is_corner = is_outermost && (i - DiscPattern::ring_start(ring)) % static_cast<std::size_t>(ring) == 0;
    EXPECT_EQ(neighbours, is_corner ? 3 : is_outermost ? 4 : 6) << i;
  }
}

TEST(DiscPattern, SaysHowFarPointsLieFromEvenStepsAroundTheirCircle) {
  for (const DiscSubdivision subdivision : {DiscSubdivision::rings, DiscSubdivision::hexagons}) {
    const DiscPattern pattern(20.0, 0.1, subdivision);
    double widest = 0.0;
    for (std::size_t i = 0; i < pattern.point_count(); ++i) {
      const int ring = DiscPattern::ring_of(i);
      const double turns =
          static_cast<double>(i - DiscPattern::ring_start(ring)) / static_cast<double>(DiscPattern::ring_size(ring));
      const double angle = 2.0 * std::numbers::pi * turns;
      const Eigen::Vector2d even_mm = 0.1 * ring * Eigen::Vector2d(std::cos(angle), std::sin(angle));
      const double deviation_mm = (pattern.point_mm(i) - even_mm).norm();
      ASSERT_LE(deviation_mm, pattern.deviation_mm(ring) + 1e-13) << i;
      if (ring > 0) widest = std::max(widest, deviation_mm / (0.1 * ring));
    }
    // A hexagon's flats lie 1 - cos 30 degrees, 0.134 of its radius, nearer.
    if (subdivision == DiscSubdivision::hexagons) {
      EXPECT_NEAR(widest, 1.0 - std::cos(std::numbers::pi / 6.0), 1e-3);
    }
  }
}

TEST(DiscPattern, SharesAHexagonsVolumeAmongItsPoints) {
  const DiscPattern pattern(3.0, 0.1, DiscSubdivision::hexagons);
  double sum_mm3 = 0.0;
  for (int ring = 0; ring < pattern.ring_count(); ++ring) {
    sum_mm3 += static_cast<double>(DiscPattern::ring_size(ring)) * pattern.point_volume_mm3(ring);
  }
  // A hexagon of half a spacing beyond the last corner of 2.9 mm has area 3/2 sqrt(3) r²; its points' share is that but
  // for a quarter of a point: 3n(n-1) + 1 = 3 (n - 1/2)² + 1/4.
  const double hexagon_mm3 = 1.5 * std::numbers::sqrt3 * 2.95 * 2.95 * 0.1;
  EXPECT_NEAR(sum_mm3, hexagon_mm3 + 0.25 * pattern.point_volume_mm3(1), 1e-12);
}

TEST(DiscPattern, RoundsTheNumberOfRings) {
  // 0.3 / 0.1 is 2.9999999999999996.
  EXPECT_EQ(DiscPattern(0.3, 0.1).ring_count(), 3);
  EXPECT_EQ(DiscPattern(0.34, 0.1).ring_count(), 3);
  EXPECT_EQ(DiscPattern(0.36, 0.1).ring_count(), 4);
}

TEST(DiscPattern, RejectsSizesWithoutSense) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinite = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, infinite, -infinite, 0.0, -1.0}) {
    EXPECT_THROW(DiscPattern(bad, 0.1), Error) << bad;
    EXPECT_THROW(DiscPattern(3.0, bad), Error) << bad;
  }
  EXPECT_THROW(DiscPattern(0.04, 0.1), Error);
  EXPECT_THROW(DiscPattern(3.0, 1e-5), Error);
  EXPECT_THROW(DiscPattern(1e300, 1e-300), Error);
}

}  // namespace
}  // namespace spinaltap
