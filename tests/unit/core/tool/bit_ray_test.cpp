// Compiled with optimisation: long loops of its own.

#include "core/tool/bit_ray.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/base/error.h"
#include "core/base/random.h"

namespace spinaltap {
namespace {

const std::vector<DrillBit> kRayBits{DrillBit{3.0, 20.0, 4.0},
                                     twist_drill(3.2, 20.0, 118.0, 0.4),
                                     DrillBit{4.0, 15.0, 1.0, BitShape::round_burr, 0.0, 2.0},
                                     DrillBit{3.6, 15.0, 4.0, BitShape::conical_burr, 1.0, 2.0},
                                     DrillBit{5.5, 20.0, 4.0, BitShape::tapered_screw, 4.0},
                                     profile_bit({{0.0, 0.3}, {2.0, 1.8}, {5.0, 1.8}, {5.0, 1.2}, {15.0, 1.2}}),
                                     profile_bit({{0.0, 0.0},
                                                  {1.5, 1.5, true},
                                                  {4.0, 1.5},
                                                  {4.5, 0.8},
                                                  {9.0, 0.8},
                                                  {10.0, 1.9},
                                                  {14.0, 1.1, true},
                                                  {15.0, 1.1}})};

Vec3 random_vector(std::uint64_t seed, std::uint64_t index) {
  return {random_normal(seed, 3 * index), random_normal(seed, 3 * index + 1), random_normal(seed, 3 * index + 2)};
}

/// Rays that pass a bit askew, across its axis, along it and along its cone.
Vec3 direction_of(std::uint64_t n, const Pose& pose) {
  const Vec3 any = random_vector(2, n).normalized();
  switch (n % 4) {
    case 0:
      return pose.axis;
    case 1:
      return (any - any.dot(pose.axis) * pose.axis).normalized();
    case 2:
      return (pose.axis + 0.02 * any).normalized();
    default:
      return any;
  }
}

/// Rays around a place of the body run within it where their points lie in it; returns how many stretches did.
std::size_t stretches_that_hold(const BitBody& body, const Vec3& middle_mm, std::uint64_t rays) {
  std::size_t met = 0;
  for (std::uint64_t n = 0; n < rays; ++n) {
    const Vec3 direction = direction_of(n, body.pose());
    const Vec3 start_mm = middle_mm + 1.5 * random_vector(1, n) - 60.0 * direction;
    std::vector<RayStretch> stretches;
    body.append_stretches(start_mm, direction, stretches);
    join_stretches(stretches);
    met += stretches.size();
    for (const RayStretch& stretch : stretches) {
      for (const double end_mm : {stretch.begin_mm, stretch.end_mm}) {
        EXPECT_NEAR(body.distance_mm(start_mm + end_mm * direction), 0.0, 1e-6) << "ray " << n;
      }
    }
    for (double t = 0.0; t < 120.0; t += 0.05) {
      const double distance_mm = body.distance_mm(start_mm + t * direction);
      if (std::abs(distance_mm) < 1e-6) continue;
      bool is_within = false;
      for (const RayStretch& stretch : stretches) is_within |= stretch.begin_mm < t && t < stretch.end_mm;
      EXPECT_EQ(is_within, distance_mm < 0.0) << "ray " << n << " at " << t << " mm, " << distance_mm;
    }
  }
  return met;
}

TEST(BitBody, HasARayWithinItWhereTheRaysPointsAre) {
  const Pose pose{Vec3(12.0, -30.0, 105.0), Vec3(0.3, -0.8, 0.4).normalized()};
  for (const DrillBit& bit : kRayBits) {
    for (const double way_mm : {0.0, 7.5}) {
      const BitProfile profile(bit);
      const BitBody body(profile.widens_to_one_place() ? profile.lengthened(way_mm) : profile, pose);
      EXPECT_GT(stretches_that_hold(body, pose.tip_mm - 0.5 * bit.length_mm * pose.axis, 400), 150U);
    }
  }
}

TEST(BitBody, OfAPlateIsABoxThatIsHeldByItsSide) {
  const Vec3 axis = Vec3(0.3, -0.8, 0.4).normalized(), tip_mm(12.0, -30.0, 105.0);
  DrillBit plate = plate_bit(6.0, 1.2, 20.0);
  const Vec3 side = axis.cross(Vec3(0.2, 0.1, 0.9)).normalized(), thick = axis.cross(side);
  const BitBody body(plate, {tip_mm, axis, side});
  EXPECT_GT(stretches_that_hold(body, tip_mm - 10.0 * axis, 400), 150U);
  // Beside its faces and beyond its ends and corners, by Pythagoras.
  EXPECT_NEAR(body.distance_mm(tip_mm + 4.0 * side - 2.0 * axis), 1.0, 1e-9);
  EXPECT_NEAR(body.distance_mm(tip_mm + 0.5 * thick - 2.0 * axis), -0.1, 1e-9);
  EXPECT_NEAR(body.distance_mm(tip_mm + 3.0 * axis), 3.0, 1e-9);
  EXPECT_NEAR(body.distance_mm(tip_mm - 5.0 * side + 1.6 * thick - 22.0 * axis), 3.0, 1e-9);
  EXPECT_NEAR((body.normal(tip_mm + 0.6 * thick - 3.0 * axis + 2.0 * side) - thick).norm(), 0.0, 1e-9);
  EXPECT_NEAR((body.normal(tip_mm - 3.0 * side - 3.0 * axis) + side).norm(), 0.0, 1e-9);
  // Not said, its width lies as the plate has it.
  plate.width_along = Vec3::UnitX();
  const Vec3 along = (Vec3::UnitX() - axis.x() * axis).normalized();
  EXPECT_NEAR(BitBody(plate, {tip_mm, axis}).distance_mm(tip_mm + 4.0 * along - 2.0 * axis), 1.0, 1e-9);
  EXPECT_THROW(BitBody(plate, {tip_mm, Vec3::UnitX()}), Error);
  EXPECT_THROW(BitBody(plate, {tip_mm, axis, axis}), Error);
}

TEST(BitBody, HasNormalsThatPointOut) {
  const BitBody body(BitProfile{kRayBits[0]}, {Vec3::Zero(), -Vec3::UnitZ()});
  EXPECT_NEAR((body.normal({1.5, 0.0, 10.0}) - Vec3::UnitX()).norm(), 0.0, 1e-9);
  EXPECT_NEAR((body.normal({0.0, -0.75, 2.0}) - Vec3(0.0, -4.0, -1.5).normalized()).norm(), 0.0, 1e-9);
  EXPECT_NEAR((body.normal({0.3, 0.3, 20.0}) - Vec3::UnitZ()).norm(), 0.0, 1e-9);
}

TEST(JoinStretches, MakesOneOfThoseThatTouch) {
  std::vector<RayStretch> stretches{{5.0, 6.0}, {1.0, 2.0}, {2.0 + 1e-9, 3.0}, {5.5, 5.7}};
  join_stretches(stretches);
  ASSERT_EQ(stretches.size(), 2U);
  EXPECT_EQ(stretches[0].begin_mm, 1.0);
  EXPECT_EQ(stretches[0].end_mm, 3.0);
  EXPECT_EQ(stretches[1].end_mm, 6.0);
}

}  // namespace
}  // namespace spinaltap
