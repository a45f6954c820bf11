// Compiled with optimisation: long loops of its own.

#include "core/engine/detail/ring_gaps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/unit/core/engine/askew_block.h"

namespace spinaltap {
namespace {

using test::Draw;

constexpr std::uint64_t kGapSeed = 160;
constexpr double kFloatMm = 2e-5;

/// Points of a disc of which some live, and the gap of a ring around a place that is dead.
struct Disc {
  explicit Disc(const DiscPattern& p) : pattern(&p), lives(p.point_count(), true) {}
  const DiscPattern* pattern;
  std::vector<bool> lives;

  /// Kills all that lies within a circle, and notes the gaps that this leaves.
  void drill(double x_mm, double y_mm, double radius_mm, RingGaps& gaps) {
    for (std::size_t i = 0; i < lives.size(); ++i) {
      if ((pattern->point_mm(i) - Eigen::Vector2d(x_mm, y_mm)).norm() < radius_mm) lives[i] = false;
    }
    for (int ring = 0; ring < pattern->ring_count(); ++ring) {
      const std::size_t start = DiscPattern::ring_start(ring);
      const std::size_t size = DiscPattern::ring_size(ring);
      std::size_t occupied = 0;
      for (std::size_t i = 0; i < size; ++i) occupied += lives[start + i];
      if (occupied == 0) {
        gaps.set_dead(0, ring);
        continue;
      }
      const double turns = std::atan2(y_mm, x_mm) / (2.0 * std::numbers::pi);
      const auto middle = static_cast<std::size_t>(std::floor((turns + 1.0) * static_cast<double>(size))) % size;
      if (lives[start + middle]) continue;
      std::size_t below = middle;
      while (!lives[start + below]) below = (below + size - 1) % size;
      std::size_t above = middle;
      while (!lives[start + above]) above = (above + 1) % size;
      gaps.set_gap(0, ring, below, above);
    }
  }

  /// The least distance of a ring's occupied points from a place, as the ellipse counts it.
  double nearest_mm(int ring, double x_mm, double y_mm, const detail::FloatEllipse& ellipse) const {
    double nearest_mm = 1e15;
    const std::size_t start = DiscPattern::ring_start(ring);
    for (std::size_t i = start; i < start + DiscPattern::ring_size(ring); ++i) {
      if (!lives[i]) continue;
      const Eigen::Vector2d from = pattern->point_mm(i) - Eigen::Vector2d(x_mm, y_mm);
      const double along = from.x() * ellipse.tilt_x + from.y() * ellipse.tilt_y;
      nearest_mm = std::min(nearest_mm, std::sqrt(from.squaredNorm() - along * along));
    }
    return nearest_mm;
  }
};

detail::FloatEllipse ellipse(double tilt, double turn_rad) {
  return {static_cast<float>(tilt * std::cos(turn_rad)), static_cast<float>(tilt * std::sin(turn_rad)),
          static_cast<float>(1.0 - tilt * tilt)};
}

/// How a drill's bounds count: the plane across its axis, its cylinder and its cone, tilted a little and far.
detail::FloatEllipse random_ellipse(Draw& draw) {
  const double tilt = draw(0.0, 1.0) < 0.5 ? draw(0.0, 0.2) : draw(0.0, 0.95);
  return ellipse(draw(0.0, 1.0) < 0.1 ? 0.0 : tilt, draw(0.0, 2.0 * std::numbers::pi));
}

TEST(RingGaps, NeverPassOverAnOccupiedPointWithinReachWithAnyInstructions) {
  SCOPED_TRACE(::testing::Message() << "seed " << kGapSeed);
  const auto& kernels = detail::disc_kernels();
  Draw draw(kGapSeed);
  const DiscPattern pattern(3.0, 0.1);
  const int rings = pattern.ring_count();
  std::size_t passed_over = 0;
  std::size_t looked_at = 0;
  for (int run = 0; run < 60; ++run) {
    Disc disc(pattern);
    std::vector<RingGaps> sets;
    for (const detail::DiscKernels& kernel : kernels) sets.emplace_back(1, pattern, kernel);
    double x_mm = draw(-1.0, 1.0);
    double y_mm = draw(-1.0, 1.0);
    for (int step = 0; step < 40; ++step) {
      const Disc before = disc;
      for (RingGaps& gaps : sets) {
        disc = before;
        disc.drill(x_mm, y_mm, 1.5, gaps);
      }
      x_mm += draw(-0.1, 0.1);
      y_mm += draw(-0.1, 0.1);
      const double reach_mm = draw(0.0, 1.0) < 0.1 ? -1.0 : draw(1.3, 1.7);
      const detail::FloatEllipse counted = random_ellipse(draw);
      const int begin = static_cast<int>(draw(0.0, 5.0));
      const int end = rings - static_cast<int>(draw(0.0, 5.0));
      std::vector<std::uint8_t> first;
      double first_mm = 0.0;
      for (std::size_t n = 0; n < sets.size(); ++n) {
        SCOPED_TRACE(kernels[n].name);
        std::vector<std::uint8_t> reached(static_cast<std::size_t>(rings) + detail::kLongestVector, 7);
        const double min_mm = sets[n].min_distance_mm(0, begin, end, x_mm, y_mm, reach_mm, counted, reached.data());
        reached.resize(static_cast<std::size_t>(end - begin));
        if (n == 0) {
          first = reached;
          first_mm = min_mm;
        }
        ASSERT_EQ(reached, first);
        ASSERT_EQ(min_mm, first_mm);
      }
      for (int ring = begin; ring < end; ++ring) {
        const double nearest_mm = disc.nearest_mm(ring, x_mm, y_mm, counted);
        if (first[static_cast<std::size_t>(ring - begin)] != 0) {
          ++looked_at;
          continue;
        }
        ++passed_over;
        ASSERT_GE(nearest_mm, reach_mm - kFloatMm) << "ring " << ring;
        ASSERT_GE(nearest_mm, first_mm - kFloatMm) << "ring " << ring;
      }
    }
  }
  // They do say something: most rings need no look.
  EXPECT_GT(passed_over, looked_at);
}

TEST(RingGaps, SayNothingOfDeadRings) {
  const DiscPattern pattern(1.0, 0.1);
  RingGaps gaps(3, pattern, detail::disc_kernels().back());
  std::vector<std::uint8_t> reached(static_cast<std::size_t>(pattern.ring_count()) + detail::kLongestVector);
  for (int ring = 0; ring < pattern.ring_count(); ++ring) {
    EXPECT_FALSE(gaps.is_dead(1, ring));
    gaps.set_dead(1, ring);
    EXPECT_TRUE(gaps.is_dead(1, ring));
    EXPECT_FALSE(gaps.is_dead(0, ring));
    EXPECT_FALSE(gaps.is_dead(2, ring));
  }
  EXPECT_GT(gaps.min_distance_mm(1, 0, pattern.ring_count(), 0.0, 0.0, 5.0, detail::kCircle, reached.data()), 1e14);
  for (int ring = 0; ring < pattern.ring_count(); ++ring) EXPECT_EQ(reached[static_cast<std::size_t>(ring)], 0);
}

}  // namespace
}  // namespace spinaltap
