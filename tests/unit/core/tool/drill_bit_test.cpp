#include "core/tool/bit_profile.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "tests/support/bit_contains.h"
#include "tests/unit/core/engine/tools.h"

namespace spinaltap {
namespace {

constexpr std::uint64_t kBitSeed = 20'040'901;

const BitProfile kPaperBit(DrillBit{3.0, 50.0, 5.0});
const Pose kUpright{Vec3(0, 0, 50), Vec3::UnitZ()};

TEST(DrillBit, KnowsItsDistanceAtBaseTipRimAndShoulder) {
  EXPECT_NEAR(bit_distance_mm(kPaperBit, kUpright, Vec3(0, 0, 50)), 0.0, 1e-15);    // tip
  EXPECT_NEAR(bit_distance_mm(kPaperBit, kUpright, Vec3(0, 0, 52)), 2.0, 1e-14);    // ahead of it
  EXPECT_NEAR(bit_distance_mm(kPaperBit, kUpright, Vec3(0, 0, -2)), 2.0, 1e-14);    // behind the base
  EXPECT_NEAR(bit_distance_mm(kPaperBit, kUpright, Vec3(4.5, 0, -4)), 5.0, 1e-14);  // off the base's rim: 3-4-5
  EXPECT_NEAR(bit_distance_mm(kPaperBit, kUpright, Vec3(0, 2.5, 20)), 1.0, 1e-14);  // beside the wall
  EXPECT_NEAR(bit_distance_mm(kPaperBit, kUpright, Vec3(0, 0, 20)), -1.5, 1e-14);   // on the axis
  EXPECT_NEAR(bit_distance_mm(kPaperBit, kUpright, Vec3(0, 0, 0.5)), -0.5, 1e-14);  // just within the base
  EXPECT_NEAR(bit_distance_mm(kPaperBit, kUpright, Vec3(1.5, 0, 45)), 0.0, 1e-14);  // shoulder
  // On the axis within the cone, the cone is nearest: depth times the sine of its half angle.
  const double sine = 1.5 / std::hypot(1.5, 5.0);
  EXPECT_NEAR(bit_distance_mm(kPaperBit, kUpright, Vec3(0, 0, 48)), -2.0 * sine, 1e-14);
}

TEST(DrillBit, CountsItsSurfaceAsInside) {
  EXPECT_TRUE(test::bit_contains(kPaperBit, kUpright, Vec3(0, 0, 50)));
  EXPECT_TRUE(test::bit_contains(kPaperBit, kUpright, Vec3(0, 0, 0)));
  EXPECT_TRUE(test::bit_contains(kPaperBit, kUpright, Vec3(1.5, 0, 20)));
  EXPECT_TRUE(test::bit_contains(kPaperBit, kUpright, Vec3(1.5, 0, 0)));
  EXPECT_FALSE(test::bit_contains(kPaperBit, kUpright, Vec3(1.5 + 1e-9, 0, 20)));
  EXPECT_FALSE(test::bit_contains(kPaperBit, kUpright, Vec3(0, 0, -1e-9)));
  EXPECT_FALSE(test::bit_contains(kPaperBit, kUpright, Vec3(0, 0, 50 + 1e-9)));
}

TEST(DrillBit, NarrowsFromTheFullRadiusWhereTheConeBeginsToNothingAtTheTip) {
  // The paper's printed factor, (1 - alpha) * cone / total, would allow 0.015 mm where the cone begins.
  for (int i = 1; i <= 50; ++i) {
    const double back_mm = 0.1 * i;
    const double radius_mm = 1.5 * back_mm / 5.0;
    EXPECT_TRUE(test::bit_contains(kPaperBit, kUpright, Vec3(radius_mm - 1e-9, 0, 50 - back_mm))) << back_mm;
    EXPECT_FALSE(test::bit_contains(kPaperBit, kUpright, Vec3(radius_mm + 1e-9, 0, 50 - back_mm))) << back_mm;
  }
}

TEST(DrillBit, MayBeAllCone) {
  const DrillBit cone{3.0, 5.0, 5.0};
  check_bit(cone);
  const Pose pose{Vec3(0, 0, 5), Vec3::UnitZ()};
  EXPECT_TRUE(test::bit_contains(BitProfile(cone), pose, Vec3(1.5 - 1e-9, 0, 0)));
  EXPECT_FALSE(test::bit_contains(BitProfile(cone), pose, Vec3(1.5 - 1e-9, 0, 0.1)));
  EXPECT_NEAR(bit_distance_mm(BitProfile(cone), pose, Vec3(0, 0, 0.25)), -0.25, 1e-14);
}

TEST(DrillBit, DoesNotCareHowPointAndPoseAreTurnedAndShiftedTogether) {
  SCOPED_TRACE(::testing::Message() << "seed " << kBitSeed);
  test::Draw draw(kBitSeed);
  for (int n = 0; n < 2'000; ++n) {
    const BitProfile bit(test::random_tool(draw));
    const Pose pose = draw.pose();
    const Vec3 p = test::point_near(bit, pose, draw);
    const Mat3 turn = Eigen::AngleAxisd(draw(0.0, 6.3), draw.direction()).toRotationMatrix();
    const Vec3 shift_mm = draw.within(Vec3::Constant(-500.0), Vec3::Constant(500.0));
    const Pose moved{turn * pose.tip_mm + shift_mm, turn * pose.axis};
    const double distance_mm = bit_distance_mm(bit, pose, p);
    // Positions of 500 mm carry 1e-13 mm each.
    EXPECT_NEAR(bit_distance_mm(bit, moved, turn * p + shift_mm), distance_mm, 1e-11);
    if (std::abs(distance_mm) < 1e-9) continue;
    EXPECT_EQ(test::bit_contains(bit, moved, turn * p + shift_mm), test::bit_contains(bit, pose, p));
  }
}

TEST(DrillBit, RejectsLengthsWithoutSense) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinite = std::numeric_limits<double>::infinity();
  for (const test::Tool& tool : test::every_tool()) {
    SCOPED_TRACE(tool.name);
    EXPECT_NO_THROW(check_bit(tool.bit));
    const auto rejects = [&](double DrillBit::*length, double bad) {
      DrillBit bit = tool.bit;
      bit.*length = bad;
      EXPECT_THROW(check_bit(bit), Error) << bad;
      EXPECT_THROW(BitProfile{bit}, Error) << bad;
    };
    const bool has_tip = tool.bit.shape != BitShape::round_burr;
    for (const double bad : {nan, -1.0, infinite, 0.0}) {
      rejects(&DrillBit::diameter_mm, bad);
      rejects(&DrillBit::length_mm, bad);
      if (has_tip) rejects(&DrillBit::tip_length_mm, bad);
      if (bad == 0.0) continue;  // pointed, or without a shank
      rejects(&DrillBit::tip_diameter_mm, bad);
      rejects(&DrillBit::shank_diameter_mm, bad);
    }
    rejects(&DrillBit::tip_diameter_mm, 1.001 * tool.bit.diameter_mm);
    rejects(&DrillBit::shank_diameter_mm, 1.001 * tool.bit.diameter_mm);
    if (has_tip) rejects(&DrillBit::tip_length_mm, 1.001 * tool.bit.length_mm);
  }
  // A ball shorter than its radius would have no widest place.
  EXPECT_THROW(check_bit({3.0, 1.5, 1.0, BitShape::round_burr, 0.0, 0.0}), Error);
}

TEST(DrillBit, TakesATwistDrillsOutlineFromItsPointAngle) {
  // Half of 118 degrees: 1.3 mm aside over its tangent.
  const DrillBit bit = twist_drill(3.0, 40.0, 118.0, 0.4);
  EXPECT_NEAR(bit.tip_length_mm, 1.3 / 1.664279482350518, 1e-12);
  EXPECT_EQ(bit.tip_diameter_mm, 0.4);
  EXPECT_EQ(bit.shape, BitShape::drill);
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), 0.0, 19.9, 180.0, -118.0}) {
    EXPECT_THROW(twist_drill(3.0, 40.0, bad, 0.4), Error) << bad;
  }
  EXPECT_THROW(twist_drill(3.0, 40.0, 118.0, 3.1), Error);
  EXPECT_THROW(twist_drill(3.0, 40.0, 118.0, -0.1), Error);
  EXPECT_THROW(twist_drill(3.0, 2.0, 20.0, 0.0), Error);  // a tip of 8.5 mm
}

}  // namespace
}  // namespace spinaltap
