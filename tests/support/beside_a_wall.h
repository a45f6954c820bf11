#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/uncertainty/placement_probabilities.h"
#include "tests/support/planning_bones.h"

namespace spinaltap::test {

/// A block of bone with a flat lateral wall, and screws beside it.
class BesideAWall : public ::testing::Test {
 protected:
  static constexpr double kRadiusMm = 3.0;  ///< of the screws

  static const WallDistance& walls() {
    static const Block block;
    static const WallDistance walls(block.bone(), block.landmarks());
    return walls;
  }
  /// From the block's back straight forward; `beside_mm` of bone to its lateral wall, on the left or the right.
  static DrillPath path(double beside_mm, double side = 1.0) {
    const double x_mm = side * (Block::kHalfWidthMm - kRadiusMm - beside_mm);
    DrillPath path{"", Vec3(x_mm, Block::kHalfDepthMm, 0.0), Vec3(x_mm, -12.0, 0.0), {}};
    path.screw = PedicleScrew{"", 2.0 * kRadiusMm, 45.0, 4.0};
    return path;
  }
};

/// The standard normal distribution's function.
inline double normal_share(double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }

/// A probability that is known: in the interval, and nearer than its draws, which are evenly spread, would be at
/// random.
inline void expect_share(const Probability& found, double expected, double tolerance) {
  EXPECT_NEAR(found.share, expected, tolerance);
  EXPECT_LE(found.interval.low, expected);
  EXPECT_GE(found.interval.high, expected);
}

}  // namespace spinaltap::test
