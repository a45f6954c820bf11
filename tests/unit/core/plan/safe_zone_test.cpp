#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/plan/suggest.h"
#include "tests/support/planning_bones.h"

namespace spinaltap {
namespace {

constexpr double kShaftRadiusMm = 3.0;
constexpr double kConeMm = 4.0;
constexpr double kLengthMm = 32.0;

const WallDistance& walls() {
  static const test::Block block;
  static const WallDistance of_block(block.bone(), block.landmarks());
  return of_block;
}

/// From the block's back straight forward.
DrillPath straight_forward(double x_mm, double z_mm) {
  const Vec3 entry_mm(x_mm, test::Block::kHalfDepthMm, z_mm);
  DrillPath path{"", entry_mm, entry_mm - kLengthMm * Vec3::UnitY(), {}};
  path.screw = PedicleScrew{"", 2.0 * kShaftRadiusMm, kLengthMm, kConeMm};
  return path;
}

/// The angle at which the screw's edge, where its cone begins, has come `room_mm` further aside.
double turn_to_wall_deg(double room_mm) {
  double low = 0.0, high = 0.5;
  for (int halving = 0; halving < 60; ++halving) {
    const double middle = 0.5 * (low + high);
    const double reach_mm = (kLengthMm - kConeMm) * std::sin(middle) + kShaftRadiusMm * (std::cos(middle) - 1.0);
    (reach_mm > room_mm ? high : low) = middle;
  }
  return low * 180.0 / std::numbers::pi;
}

// Rings of the screw are looked at 0.5 mm apart along it: a wall is met at most that late.
constexpr double kZoneToleranceMm = 0.06;
constexpr double kZoneToleranceDeg = 0.2;

TEST(SafeZone, ReachesToTheWallsOfABlock) {
  const double lateral_mm = 2.0, cranial_mm = 3.0;
  for (const double side : {1.0, -1.0}) {
    const SafeZone zone =
        safe_zone(walls(), straight_forward(side * (test::Block::kHalfWidthMm - kShaftRadiusMm - lateral_mm),
                                            test::Block::kHalfHeightMm - kShaftRadiusMm - cranial_mm));
    EXPECT_NEAR(zone.lateral_mm, lateral_mm, kZoneToleranceMm) << side;
    EXPECT_NEAR(zone.cranial_mm, cranial_mm, kZoneToleranceMm) << side;
    EXPECT_NEAR(zone.lateral_deg, turn_to_wall_deg(lateral_mm), kZoneToleranceDeg) << side;
    EXPECT_NEAR(zone.cranial_deg, turn_to_wall_deg(cranial_mm), kZoneToleranceDeg) << side;
    // Far walls: no further than is looked.
    EXPECT_EQ(zone.caudal_mm, 8.0) << side;
  }
}

TEST(SafeZone, ReachesToTheCanal) {
  const double medial_mm = 1.5;
  const SafeZone zone = safe_zone(walls(), straight_forward(test::Block::kHoleMm + kShaftRadiusMm + medial_mm, 0.0));
  EXPECT_NEAR(zone.medial_mm, medial_mm, kZoneToleranceMm);
}

TEST(SafeZone, IsNothingAroundAPathThatBreaches) {
  const SafeZone zone = safe_zone(walls(), straight_forward(test::Block::kHalfWidthMm - 1.0, 0.0));
  for (const double error : {zone.medial_mm, zone.lateral_mm, zone.cranial_mm, zone.caudal_mm, zone.medial_deg,
                             zone.lateral_deg, zone.cranial_deg, zone.caudal_deg}) {
    EXPECT_EQ(error, 0.0);
  }
}

}  // namespace
}  // namespace spinaltap
