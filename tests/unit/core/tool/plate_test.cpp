#include "core/tool/plate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/error.h"
#include "core/tool/bit_profile.h"
#include "tests/support/random_drilling.h"

namespace spinaltap {
namespace {

using test::Random;
using testing::HasSubstr;
using testing::ThrowsMessage;

const DrillBit kSaw = plate_bit(12.0, 1.2, 30.0, 4.0);

Pose random_plate_pose(Random& random, double off_mm) {
  const Vec3 axis = random.direction();
  const Vec3 side = any_perpendicular(axis);
  const double turn = random(-3.0, 3.0);
  return {off_mm * random.direction(), axis, std::cos(turn) * side + std::sin(turn) * axis.cross(side)};
}

/// The pose turned by a small rotation and shifted.
Pose moved(const Pose& pose, const Vec3& way_mm, const Vec3& about, double angle_rad) {
  const Mat3 turn = Eigen::AngleAxisd(angle_rad, about).toRotationMatrix();
  const Pose turned{pose.tip_mm + way_mm, turn * pose.axis, turn * pose.side};
  return *valid_pose(turned, kSaw);
}

TEST(PlateBox, HasTheDistanceOfItsNearestPlaceAndItsSlope) {
  const PlateBox box(kSaw);
  Random random(5);
  for (int n = 0; n < 2000; ++n) {
    const Vec3 p(random(-9.0, 9.0), random(-3.0, 3.0), random(-4.0, 34.0));
    const PlateBox::Sample sample = box.sample(p);
    EXPECT_EQ(box.contains(p), sample.distance_mm <= 0.0);
    EXPECT_NEAR(sample.gradient.norm(), 1.0, 1e-12);
    if (sample.distance_mm > 0.0) {
      const Vec3 nearest = p.cwiseMax(box.low_mm()).cwiseMin(box.high_mm());
      EXPECT_NEAR(sample.distance_mm, (p - nearest).norm(), 1e-12);
    } else {
      const Vec3 low = p - box.low_mm(), high = box.high_mm() - p;
      EXPECT_NEAR(-sample.distance_mm, low.cwiseMin(high).minCoeff(), 1e-12);
    }
    constexpr double kStepMm = 1e-6;
    const double further = box.sample(p + kStepMm * sample.gradient).distance_mm;
    EXPECT_NEAR((further - sample.distance_mm) / kStepMm, 1.0, 1e-4);
  }
}

TEST(SweptPlate, TakesWhatADenseWalkTakes) {
  const PlateSweep sweep(kSaw);
  constexpr int kWays = 60, kPoints = 150, kPoses = 400;
  int taken = 0, near_wall = 0;
  for (std::uint64_t seed = 0; seed < kWays; ++seed) {
    Random random(seed);
    const Pose from = random_plate_pose(random, 3.0);
    const double way_mm = std::pow(10.0, random(-2.0, 0.5));
    const double angle = seed % 3 == 0 ? 0.0 : std::pow(10.0, random(-4.0, -0.5));
    const Pose to = moved(from, way_mm * random.direction(), random.direction(), angle);
    const PlateMotion motion(sweep, from, to);
    for (int n = 0; n < kPoints; ++n) {
      const double share = random(0.0, 1.0);
      const Pose about = motion.pose_at(share);
      // Near a wall, where it matters.
      Vec3 seen(random(-6.5, 6.5), random(-0.9, 0.9), random(-0.6, 31.0));
      if (n % 2 == 0) seen.y() = (random(0.0, 1.0) < 0.5 ? -0.6 : 0.6) + random(-0.05, 0.05);
      const Vec3 p = about.tip_mm + plate_rows(about).transpose() * seen;
      bool is_taken = false;
      for (std::size_t piece = 0; piece < motion.piece_count(); ++piece) is_taken |= motion.piece(piece).contains(p);
      double least_mm = std::numeric_limits<double>::infinity(), most_step_mm = 0.0, before_mm = 0.0;
      for (int k = 0; k <= kPoses; ++k) {
        const Pose pose = motion.pose_at(static_cast<double>(k) / kPoses);
        const double distance_mm = sweep.box.sample(plate_rows(pose) * (p - pose.tip_mm)).distance_mm;
        if (k > 0) most_step_mm = std::max(most_step_mm, std::abs(distance_mm - before_mm));
        before_mm = distance_mm;
        least_mm = std::min(least_mm, distance_mm);
      }
      // What a dense walk passes is taken; what is taken it passes within a skin and its own step.
      if (least_mm < -1e-9) {
        EXPECT_TRUE(is_taken) << seed << ", " << n << ": " << least_mm;
      }
      if (is_taken) {
        EXPECT_LT(least_mm, 3e-3 + most_step_mm) << seed << ", " << n;
      }
      taken += is_taken ? 1 : 0;
      near_wall += std::abs(least_mm) < 0.05 ? 1 : 0;
    }
  }
  EXPECT_GT(taken, kWays * kPoints / 4);
  EXPECT_GT(near_wall, kWays * kPoints / 10);
}

TEST(PlateMotion, IsStraightWithoutATurnAndCutWhereItBends) {
  const PlateSweep sweep(kSaw);
  const Pose from{Vec3::Zero(), Vec3::UnitZ(), Vec3::UnitX()};
  EXPECT_EQ(PlateMotion(sweep, from, moved(from, Vec3(0.3, 0.2, 4.0), Vec3::UnitZ(), 0.0)).piece_count(), 1U);
  // A roll of a degree about the axis: the far corner's sagitta, by geometry, is reach * (1 - cos(0.5 degree)).
  const double degree = std::numbers::pi / 180.0;
  const PlateMotion roll(sweep, from, moved(from, Vec3::Zero(), Vec3::UnitZ(), degree));
  EXPECT_GE(roll.bend_mm(), 6.0 * (1.0 - std::cos(0.5 * degree)));
  EXPECT_LE(roll.bend_mm(), 6.0 * 6.0 * (1.0 - std::cos(0.5 * degree)));
  const Pose half = roll.pose_at(0.5);
  EXPECT_NEAR(half.side.dot(Vec3(std::cos(0.5 * degree), std::sin(0.5 * degree), 0.0)), 1.0, 1e-12);
  // Half a turn has a middle too, at right angles to both ends.
  const PlateMotion about(sweep, from, {Vec3::Zero(), -Vec3::UnitZ(), Vec3::UnitX()});
  EXPECT_NEAR(about.pose_at(0.5).axis.z(), 0.0, 1e-9);
  EXPECT_NEAR((about.pose_at(1.0).axis + Vec3::UnitZ()).norm(), 0.0, 1e-9);
}

TEST(PlatePose, TakesItsOwnSideOrTheToolsOrNone) {
  Pose pose{Vec3(1, 2, 3), Vec3::UnitY()};
  EXPECT_EQ(valid_pose(pose, kSaw)->side, Vec3::UnitZ()) << "headwards";
  pose.side = Vec3::UnitX();
  EXPECT_EQ(valid_pose(pose, kSaw)->side, Vec3::UnitX());
  EXPECT_EQ(valid_pose(pose, DrillBit{})->side, Vec3::Zero()) << "a body of revolution has none";
  pose.side = Vec3(1.003, 0.004, 0.0);  // as floats may round it
  const Vec3 side = valid_pose(pose, kSaw)->side;
  EXPECT_NEAR(side.norm(), 1.0, 1e-12);
  EXPECT_NEAR(side.y(), 0.0, 1e-12);
  pose.side = Vec3(0.7, 0.7, 0.0);
  EXPECT_FALSE(valid_pose(pose, kSaw)) << "not across the axis";
  pose.side = Vec3(std::nan(""), 0.0, 0.0);
  EXPECT_FALSE(valid_pose(pose, kSaw));
  EXPECT_FALSE(valid_pose({Vec3::Zero(), Vec3::UnitZ()}, kSaw)) << "along what it is held by";
  DrillBit held = kSaw;
  held.width_along = Vec3(0.6, 0.8, 0.0);
  EXPECT_EQ(valid_pose({Vec3::Zero(), Vec3::UnitZ()}, held)->side, held.width_along);
}

TEST(Plate, RejectsSizesThatMakeNoSense) {
  EXPECT_THAT([] { plate_bit(12.0, 13.0, 30.0); }, ThrowsMessage<Error>(HasSubstr("thickness from 0.05 to 12 mm")));
  EXPECT_THAT([] { plate_bit(12.0, 0.0, 30.0); }, ThrowsMessage<Error>(HasSubstr("thickness")));
  EXPECT_THAT([] { plate_bit(300.0, 1.0, 30.0); }, ThrowsMessage<Error>(HasSubstr("width")));
  EXPECT_THAT([] { plate_bit(12.0, 1.0, std::nan("")); }, ThrowsMessage<Error>(HasSubstr("length")));
  EXPECT_THAT([] { plate_bit(12.0, 1.0, 30.0, 12.0); }, ThrowsMessage<Error>(HasSubstr("stroke")));
  DrillBit drill;
  drill.thickness_mm = 1.0;
  EXPECT_THAT([&] { check_bit(drill); }, ThrowsMessage<Error>(HasSubstr("plates only")));
  DrillBit tipped = kSaw;
  tipped.tip_length_mm = 2.0;
  EXPECT_THAT([&] { check_bit(tipped); }, ThrowsMessage<Error>(HasSubstr("neither tip nor shank")));
  EXPECT_THAT([] { BitProfile{kSaw}; }, ThrowsMessage<Error>(HasSubstr("body of revolution")));
  EXPECT_THAT([] { PlateBox{DrillBit{}}; }, ThrowsMessage<Error>(HasSubstr("expected a plate")));
  const DrillBit larger = resized(kSaw, 24.0, 40.0);
  EXPECT_EQ(larger.thickness_mm, 2.4);
  EXPECT_EQ(larger.stroke_mm, 8.0);
}

}  // namespace
}  // namespace spinaltap
