#include "core/tool/bit_profile.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/bit_contains.h"
#include "tests/unit/core/engine/tools.h"

namespace spinaltap {
namespace {

using test::Draw;
using test::Tool;

constexpr std::uint64_t kProfileSeed = 20'261'121;

TEST(BitProfile, ContainsWhereTheDistanceIsNegative) {
  SCOPED_TRACE(::testing::Message() << "seed " << kProfileSeed);
  Draw draw(kProfileSeed);
  int inside = 0;
  for (int n = 0; n < 40'000; ++n) {
    const BitProfile bit(test::random_tool(draw));
    const Pose pose = draw.pose();
    const Vec3 p = test::point_near(bit, pose, draw);
    const double distance_mm = bit_distance_mm(bit, pose, p);
    if (std::abs(distance_mm) < 1e-9) continue;  // rounding decides there
    ASSERT_EQ(test::bit_contains(bit, pose, p), distance_mm < 0.0) << n << " at " << distance_mm << " mm";
    inside += distance_mm < 0.0;
  }
  EXPECT_GT(inside, 4'000);
  EXPECT_LT(inside, 36'000);
}

TEST(BitProfile, HoldsWhatEachShapeIsSaidToHold) {
  // Allowed radii at places back from the tip, by hand.
  struct Place {
    double back_mm, radius_mm;
  };
  const auto expect = [](const DrillBit& bit, std::initializer_list<Place> places) {
    const BitProfile profile(bit);
    for (const Place& place : places) {
      const double within_mm = place.radius_mm - 1e-9;
      const double beyond_mm = place.radius_mm + 1e-9;
      EXPECT_TRUE(profile.contains(place.back_mm, within_mm * within_mm)) << place.back_mm;
      EXPECT_FALSE(profile.contains(place.back_mm, beyond_mm * beyond_mm)) << place.back_mm;
    }
  };
  expect({3.0, 50.0, 5.0}, {{1.0, 0.3}, {2.5, 0.75}, {5.0, 1.5}, {30.0, 1.5}, {50.0, 1.5}});
  // 90 degrees: a millimetre back for one aside, from the chisel edge of 0.4 mm on.
  expect(twist_drill(3.0, 40.0, 90.0, 0.4), {{0.0, 0.2}, {0.5, 0.7}, {1.3, 1.5}, {40.0, 1.5}});
  // A ball of radius 2: Pythagoras. The shank of 1.2 mm meets it sqrt(4 - 0.36) behind its centre.
  const double neck_mm = 2.0 + std::sqrt(3.64);
  expect({4.0, 30.0, 5.0, BitShape::round_burr, 0.0, 1.2},
         {{1.0, std::sqrt(3.0)},
          {2.0, 2.0},
          {3.2, 1.6},
          {neck_mm - 1e-3, std::sqrt(0.36 + 2e-3 * (neck_mm - 2.0) - 1e-6)},
          {neck_mm + 0.1, 0.6},
          {30.0, 0.6}});
  expect({3.0, 20.0, 4.0, BitShape::conical_burr, 1.0, 0.8},
         {{0.0, 0.5}, {2.0, 1.0}, {3.999, 1.49975}, {4.1, 0.4}, {20.0, 0.4}});
  expect({6.0, 42.0, 2.0, BitShape::tapered_screw, 4.0, 0.0}, {{1.0, 1.0}, {2.0, 2.0}, {22.0, 2.5}, {42.0, 3.0}});
}

TEST(BitProfile, EndsAtItsHeadWithoutAShank) {
  EXPECT_EQ(BitProfile({3.0, 20.0, 1.0, BitShape::round_burr, 0.0, 0.0}).length_mm(), 3.0);
  EXPECT_EQ(BitProfile({3.0, 2.5, 1.0, BitShape::round_burr, 0.0, 0.0}).length_mm(), 2.5);
  EXPECT_EQ(BitProfile({3.0, 20.0, 4.0, BitShape::conical_burr, 1.0, 0.0}).length_mm(), 4.0);
  EXPECT_FALSE(BitProfile({3.0, 20.0, 4.0, BitShape::conical_burr, 1.0, 0.0}).contains(4.1, 0.0));
  EXPECT_EQ(BitProfile({3.0, 20.0, 4.0, BitShape::conical_burr, 1.0, 0.1}).length_mm(), 20.0);
}

TEST(BitProfile, IsAsFarAsTheNearestOfManyPlacesOfItsOutline) {
  SCOPED_TRACE(::testing::Message() << "seed " << kProfileSeed);
  Draw draw(kProfileSeed + 1);
  constexpr double kStepMm = 1e-3;
  for (const Tool& tool : test::every_tool()) {
    SCOPED_TRACE(tool.name);
    const BitProfile bit(tool.bit);
    const std::vector<Eigen::Vector2d> places = test::outline(bit, kStepMm);
    for (int n = 0; n < 400; ++n) {
      const Pose pose = draw.pose();
      const Vec3 p = test::point_near(bit, pose, draw);
      // The nearest place of a body of revolution lies in p's own half plane.
      const Eigen::Vector2d q((pose.tip_mm - p).dot(pose.axis), (p - pose.tip_mm).cross(pose.axis).norm());
      double nearest_mm = std::numeric_limits<double>::infinity();
      for (const Eigen::Vector2d& place : places) nearest_mm = std::min(nearest_mm, (place - q).squaredNorm());
      nearest_mm = std::sqrt(nearest_mm);
      const double exact_mm = std::abs(bit_distance_mm(bit, pose, p));
      // Samples lie on the surface, so none is nearer; every place of it has one within half a step.
      ASSERT_LE(exact_mm, nearest_mm + 1e-9) << q.transpose();
      ASSERT_GE(exact_mm, nearest_mm - 0.5 * kStepMm) << q.transpose();
    }
  }
}

TEST(BitProfile, HasADistanceOfUnitSlope) {
  SCOPED_TRACE(::testing::Message() << "seed " << kProfileSeed);
  Draw draw(kProfileSeed + 2);
  int smooth = 0;
  for (int n = 0; n < 10'000; ++n) {
    const DrillBit drawn = test::random_tool(draw);
    const BitProfile bit(drawn);
    const Pose pose = draw.pose();
    const Vec3 p = test::point_near(bit, pose, draw);
    constexpr double kStepMm = 1e-4;
    Vec3 gradient;
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 step = kStepMm * Vec3::Unit(axis);
      gradient[axis] = (bit_distance_mm(bit, pose, p + step) - bit_distance_mm(bit, pose, p - step)) / (2.0 * kStepMm);
    }
    // Where two places are equally near the gradient jumps, and differences across that are shorter.
    EXPECT_LT(gradient.norm(), 1.0 + 1e-5) << n;
    // Outside a convex bit one place is nearest everywhere; the difference errs by (step / distance)².
    const bool is_convex = drawn.shape == BitShape::drill;
    const bool is_smooth = std::abs(gradient.norm() - 1.0) < 1e-5;
    if (is_convex && bit_distance_mm(bit, pose, p) > 0.05) {
      EXPECT_TRUE(is_smooth) << n;
    }
    smooth += is_smooth;
  }
  EXPECT_GT(smooth, 9'900);
}

TEST(BitProfile, NeverChangesItsDistanceFasterThanThePointMoves) {
  SCOPED_TRACE(::testing::Message() << "seed " << kProfileSeed);
  Draw draw(kProfileSeed + 3);
  for (int n = 0; n < 40'000; ++n) {
    const BitProfile bit(test::random_tool(draw));
    const Pose pose = draw.pose();
    const Vec3 p = test::point_near(bit, pose, draw);
    const Vec3 q = p + draw(0.0, 1.0) * draw.direction();
    EXPECT_LE(std::abs(bit_distance_mm(bit, pose, p) - bit_distance_mm(bit, pose, q)), (p - q).norm() + 1e-12);
  }
}

TEST(BitProfile, GrowsByASkinAndByLessThanThreeAtEdges) {
  SCOPED_TRACE(::testing::Message() << "seed " << kProfileSeed);
  Draw draw(kProfileSeed + 4);
  for (int n = 0; n < 2'000; ++n) {
    DrillBit drawn = test::random_tool(draw);
    // Flat tips too: their cones are up to 20 times as wide as long.
    if (n % 4 == 0 && drawn.shape != BitShape::profile) drawn.tip_length_mm = draw(0.05, 0.3);
    const BitProfile bit(drawn);
    const double skin_mm = n % 2 == 0 ? 1e-6 : 0.01;
    const BitProfile grown = bit.grown(skin_mm);
    const std::vector<Eigen::Vector2d> places = test::outline(bit, 0.05);
    for (int k = 0; k < 100; ++k) {
      // Edges are where it matters: every third place is an end of a piece.
      Eigen::Vector2d place = places[draw.bits() % places.size()];
      const ProfilePiece& piece = bit.pieces()[draw.bits() % bit.pieces().size()];
      if (k % 3 == 1) place = {piece.begin_mm, piece.begin_radius_mm};
      if (k % 3 == 2) place = {piece.end_mm, piece.end_radius_mm};
      const double angle = draw(0.0, 6.2832);
      const Eigen::Vector2d q = place + draw(0.0, 5.0) * skin_mm * Eigen::Vector2d(std::cos(angle), std::sin(angle));
      const double distance_mm = bit.distance_mm(q.x(), std::abs(q.y()));
      const bool is_held = grown.contains(q.x(), q.y() * q.y());
      // Lengths of 30 mm hold 4e-15 mm; their squares and cones of slope 20 more, the most where a profile's steep
      // stretch lies far back.
      const double rounding_mm = drawn.shape == BitShape::profile ? 1e-9 : 1e-12;
      if (distance_mm < skin_mm - rounding_mm) {
        ASSERT_TRUE(is_held) << n << " shape " << int(drawn.shape) << " at " << distance_mm / skin_mm << " skins";
      }
      if (distance_mm > 2.7 * skin_mm + rounding_mm) {
        ASSERT_FALSE(is_held) << n << " shape " << int(drawn.shape) << " at " << distance_mm / skin_mm << " skins";
      }
    }
  }
}

TEST(BitProfile, LiesWithinItsConeAndItsWidestRadius) {
  SCOPED_TRACE(::testing::Message() << "seed " << kProfileSeed);
  Draw draw(kProfileSeed + 5);
  for (int n = 0; n < 1'000; ++n) {
    const DrillBit drawn = test::random_tool(draw);
    const BitProfile bit(drawn);
    EXPECT_EQ(bit.radius_mm(), 0.5 * drawn.diameter_mm);
    // A profile may happen to be a drill's outline.
    if (drawn.shape != BitShape::profile) {
      EXPECT_EQ(bit.is_cone_and_cylinder(), drawn.shape == BitShape::drill);
    }
    double widest_mm = 0.0;
    for (const Eigen::Vector2d& place : test::outline(bit, 0.05)) {
      widest_mm = std::max(widest_mm, place.y());
      ASSERT_LE(place.y(), bit.radius_mm() + 1e-12);
      ASSERT_LE(place.y(), bit.cone_offset_mm() + bit.cone_slope() * place.x() + 1e-12);
    }
    EXPECT_NEAR(widest_mm, bit.radius_mm(), 0.05 * 0.05);
    if (!bit.is_cone_and_cylinder()) continue;
    for (int k = 0; k < 20; ++k) {
      const double back_mm = draw(0.0, bit.length_mm());
      const double bound_mm = std::min(bit.radius_mm(), bit.cone_offset_mm() + bit.cone_slope() * back_mm);
      EXPECT_NEAR(bit.distance_mm(back_mm, bound_mm), 0.0, 1e-12);
    }
  }
}

}  // namespace
}  // namespace spinaltap
