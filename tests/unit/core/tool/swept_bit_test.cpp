// Compiled with optimisation: long loops of its own.

#include "core/tool/swept_bit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/unit/core/engine/dense_walk.h"
#include "tests/unit/core/engine/tools.h"

namespace spinaltap {
namespace {

using test::Draw;
using test::Tool;

constexpr std::uint64_t kSweepSeed = 71;
/// "What is removed lies within 3 nm of what a perfect bit would sweep": and 2 nm for the search of the ground truth.
constexpr double kBesideMm = 5e-6;
/// "On a turning one within 3 um."
constexpr double kBesideTurningMm = 3e-3 + 2e-6;

/// Whether the pieces of the whole way hold p.
bool is_swept(const BitMotion& motion, const Vec3& p) {
  for (std::size_t n = 0; n < motion.piece_count(); ++n) {
    if (motion.piece(n).contains(p)) return true;
  }
  return false;
}

/// A point a little off the bit's surface, somewhere on its way: in or out, by nanometres to tenths of a millimetre.
Vec3 point_by_the_way(const std::vector<Eigen::Vector2d>& outline, const Pose& from, const Pose& to, Draw& draw) {
  const Pose pose = test::pose_on_way(from, to, draw(0.0, 1.0));
  const Eigen::Vector2d& place = outline[draw.bits() % outline.size()];
  const Vec3 side = draw.direction().cross(pose.axis).normalized();
  const double off_mm = std::pow(10.0, draw(-6.0, -0.7));
  return pose.tip_mm - place.x() * pose.axis + place.y() * side + off_mm * draw.direction();
}

/// A point within some 20 times `beside_mm` of the edge of what is swept, on the way from p, which is not, to the
/// middle of the bit.
Vec3 point_on_the_edge(const BitProfile& bit, const Pose& from, const Pose& to, const Vec3& p, double beside_mm,
                       Draw& draw) {
  Vec3 outside = p;
  const Pose middle = test::pose_on_way(from, to, draw(0.0, 1.0));
  Vec3 inside = middle.tip_mm - 0.4 * bit.length_mm() * middle.axis;
  while ((outside - inside).norm() > 1e-8) {
    const Vec3 between = 0.5 * (outside + inside);
    (test::min_distance_mm(bit, from, to, between, 1e-3) < 0.0 ? inside : outside) = between;
  }
  return outside + beside_mm * std::pow(10.0, draw(-1.0, 1.3)) * draw.direction();
}

/// Compares the swept bit with a dense walk at points by the way. `turn`: how far the axis turns at most.
void expect_swept_as_walked(const BitProfile& bit, double max_way_mm, double max_turn, int points, Draw& draw) {
  const SweepProfile profile(bit);
  const std::vector<Eigen::Vector2d> outline = test::outline(bit, 0.01);
  int held = 0;
  int beside = 0;
  int near = 0;
  int turning = 0;
  for (int n = 0; n < points; ++n) {
    const Pose from = draw.pose();
    const double way_mm = max_way_mm * std::pow(10.0, draw(-4.0, 0.0));
    const double turn = max_turn * std::pow(10.0, draw(-4.0, 0.0));
    const Vec3 around = draw.direction().cross(from.axis).normalized();
    const Pose to{from.tip_mm + way_mm * draw.direction(),
                  (std::cos(turn) * from.axis + std::sin(turn) * around.cross(from.axis)).normalized()};
    const Pose end = max_turn > 0.0 ? to : Pose{to.tip_mm, from.axis};
    Vec3 p = point_by_the_way(outline, from, end, draw);
    const BitMotion motion(profile, from, end);
    const double beside_mm = motion.piece(0).edge_mm() > 0.0 ? kBesideTurningMm : kBesideMm;
    turning += beside_mm > kBesideMm;
    double min_mm = test::min_distance_mm(bit, from, end, p, 1e-4);
    if (n % 2 == 0 && min_mm > 0.0) {
      p = point_on_the_edge(bit, from, end, p, beside_mm, draw);
      min_mm = test::min_distance_mm(bit, from, end, p, 1e-4);
    }
    const bool is_held = is_swept(motion, p);
    if (min_mm < -1e-12) {
      ASSERT_TRUE(is_held) << n << ": missed at " << min_mm << " mm";
      ++held;
    } else if (min_mm > beside_mm) {
      ASSERT_FALSE(is_held) << n << ": taken at " << min_mm << " mm";
      ++beside;
      near += min_mm < 20.0 * beside_mm;
    }
  }
  // Turns so small that a straight way's skin covers them are among them, and others.
  EXPECT_EQ(turning > 0, max_turn > 0.0);
  EXPECT_LT(turning, points);
  // Both answers are common, and many points lie just beside the way.
  EXPECT_GT(held, points / 10);
  EXPECT_GT(beside, points / 25);
  EXPECT_GT(near, points / 150);
}

TEST(SweptBit, TakesWhatADenseWalkTakesOnAStraightWay) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSweepSeed);
  Draw draw(kSweepSeed);
  for (const Tool& tool : test::every_tool()) {
    SCOPED_TRACE(tool.name);
    expect_swept_as_walked(BitProfile(tool.bit), 5.0, 0.0, 4'000, draw);
  }
}

TEST(SweptBit, TakesWhatADenseWalkTakesWhenTurning) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSweepSeed);
  Draw draw(kSweepSeed + 1);
  for (const Tool& tool : test::every_tool()) {
    SCOPED_TRACE(tool.name);
    expect_swept_as_walked(BitProfile(tool.bit), 2.0, 0.3, 1'500, draw);
  }
}

TEST(SweptBit, IsTheBitItselfWithoutAWay) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSweepSeed);
  Draw draw(kSweepSeed + 2);
  for (int n = 0; n < 20'000; ++n) {
    const BitProfile bit(test::random_tool(draw));
    const SweepProfile profile(bit);
    const Pose pose = draw.pose();
    const Vec3 p = test::point_near(bit, pose, draw);
    const double distance_mm = bit_distance_mm(bit, pose, p);
    if (distance_mm > 0.0 && distance_mm < kBesideMm) continue;
    ASSERT_EQ(SweptBit(profile, pose, pose).contains(p), distance_mm <= 0.0) << n << " at " << distance_mm;
  }
}

TEST(SweptBit, SweepsASlabBetweenTwoHalfCylindersWhenItGoesSideways) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSweepSeed);
  Draw draw(kSweepSeed + 3);
  const SweepProfile bit{BitProfile({3.0, 20.0, 2.0})};
  const Pose from{Vec3(-1.2, 0.3, 10.0), Vec3::UnitZ()};
  const Pose to{Vec3(1.2, 0.3, 10.0), Vec3::UnitZ()};
  const SweptBit swept(bit, from, to);
  int held = 0;
  for (int n = 0; n < 50'000; ++n) {
    // Depths in the cylinder and in the cone, where the slab and the half cylinders are narrower.
    const double z_mm = draw(-9.5, 9.9);
    const double radius_mm = std::min(1.5, 0.75 * (10.0 - z_mm));
    const Eigen::Vector2d q(draw(-3.0, 3.0), draw(-1.6, 2.2));
    const double to_segment_mm = std::hypot(q.x() - std::clamp(q.x(), -1.2, 1.2), q.y() - 0.3);
    if (std::abs(to_segment_mm - radius_mm) < kBesideMm) continue;
    ASSERT_EQ(swept.contains(Vec3(q.x(), q.y(), z_mm)), to_segment_mm < radius_mm) << q.transpose() << " " << z_mm;
    held += to_segment_mm < radius_mm;
  }
  EXPECT_GT(held, 15'000);
}

TEST(SweptBit, LeavesNoCuspsBesideALongFastWay) {
  // At poses 0.1 mm apart, cusps of a pointed tip survive; a sweep leaves none, be the way 50 mm.
  const SweepProfile bit{BitProfile({1.6, 10.0, 2.0})};
  const SweptBit swept(bit, {Vec3(-25, 0, 0), Vec3::UnitZ()}, {Vec3(25, 0, 0), Vec3::UnitZ()});
  for (int n = -2400; n <= 2400; ++n) {
    const double x_mm = 0.01 * n + 0.00317;
    EXPECT_TRUE(swept.contains(Vec3(x_mm, 0.4 - 1e-9, -1.0)));
    EXPECT_FALSE(swept.contains(Vec3(x_mm, 0.4 + kBesideMm, -1.0)));
    EXPECT_FALSE(swept.contains(Vec3(x_mm, 0.0, kBesideMm)));
  }
}

TEST(SweptBit, SaysHowFarItReachesAlongZ) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSweepSeed);
  Draw draw(kSweepSeed + 4);
  for (int n = 0; n < 3'000; ++n) {
    const BitProfile bit(test::random_tool(draw));
    const SweepProfile profile(bit);
    const Pose from = draw.pose();
    const Pose to{from.tip_mm + draw(0.0, 3.0) * draw.direction(), from.axis};
    const SweptBit swept(profile, from, to);
    for (const Eigen::Vector2d& place : test::outline(bit, 0.5)) {
      // The highest and lowest places of a circle around the axis.
      for (const Pose& pose : {from, to}) {
        const double sine = std::hypot(pose.axis.x(), pose.axis.y());
        const double z_mm = pose.tip_mm.z() - place.x() * pose.axis.z();
        ASSERT_LE(swept.lowest_z_mm(), z_mm - place.y() * sine);
        ASSERT_GE(swept.highest_z_mm(), z_mm + place.y() * sine);
      }
    }
  }
}

TEST(BitMotion, BeginsAndEndsExactlyAtItsPosesAndGoesEvenly) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSweepSeed);
  Draw draw(kSweepSeed + 5);
  const SweepProfile bit{BitProfile({3.0, 50.0, 5.0})};
  for (int n = 0; n < 500; ++n) {
    const Pose from = draw.pose();
    const Pose to{draw.pose().tip_mm, (from.axis + draw(0.0, 1.0) * draw.direction()).normalized()};
    const BitMotion motion(bit, from, to);
    const std::size_t pieces = motion.piece_count();
    ASSERT_EQ(motion.pose(0).tip_mm, from.tip_mm);
    ASSERT_EQ(motion.pose(0).axis, from.axis);
    ASSERT_EQ(motion.pose(pieces).tip_mm, to.tip_mm);
    ASSERT_EQ(motion.pose(pieces).axis, to.axis);
    for (std::size_t piece = 0; piece <= pieces; piece += 1 + pieces / 7) {
      const double t = static_cast<double>(piece) / static_cast<double>(pieces);
      const Pose expected = test::pose_on_way(from, to, t);
      ASSERT_LT((motion.pose(piece).tip_mm - expected.tip_mm).norm(), 1e-12);
      ASSERT_LT((motion.pose(piece).axis - expected.axis).norm(), 1e-12);
    }
  }
}

TEST(BitMotion, TakesFewPieces) {
  const SweepProfile bit{BitProfile({3.0, 50.0, 5.0})};
  const Pose from{Vec3(1, 2, 3), Vec3::UnitZ()};
  EXPECT_EQ(BitMotion(bit, from, {Vec3(-40, 70, 9), Vec3::UnitZ()}).piece_count(), 1U);
  const auto turned = [](double angle) { return Vec3(std::sin(angle), 0.0, std::cos(angle)); };
  // A hand's steps go with a straight way's skin; a step of a degree takes two pieces with the thicker one.
  const BitMotion step(bit, from, {Vec3(1, 2, 3.001), turned(1e-5)});
  EXPECT_EQ(step.piece_count(), 1U);
  EXPECT_EQ(step.piece(0).edge_mm(), 0.0);
  const BitMotion degree(bit, from, {Vec3(1, 2, 3.001), turned(std::numbers::pi / 180.0)});
  EXPECT_LE(degree.piece_count(), 2U);
  EXPECT_GT(degree.piece(0).edge_mm(), 0.0);
}

TEST(BitMotion, KeepsChordsWithinHalfASkinOfTheArc) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSweepSeed);
  Draw draw(kSweepSeed + 6);
  double max_mm = 0.0;
  for (int n = 0; n < 2'000; ++n) {
    const BitProfile bit(test::random_tool(draw));
    const Pose from = draw.pose();
    const Pose to{from.tip_mm + draw(0.0, 2.0) * draw.direction(),
                  (from.axis + draw(0.001, 0.3) * draw.direction()).normalized()};
    const SweepProfile profile(bit);
    const BitMotion motion(profile, from, to);
    const std::size_t piece = draw.bits() % motion.piece_count();
    // Seen from the bit: it turns about one axis all the way, by even angles.
    const Vec3 turn_axis = from.axis.cross(to.axis).normalized();
    const double angle = std::atan2(from.axis.cross(to.axis).norm(), from.axis.dot(to.axis));
    const auto seen = [&](const Vec3& p, double t) {
      const Mat3 turn = Eigen::AngleAxisd(t * angle, turn_axis).toRotationMatrix();
      return Vec3(turn.transpose() * (p - from.tip_mm - t * (to.tip_mm - from.tip_mm)));
    };
    const double pieces = static_cast<double>(motion.piece_count());
    const double begin = static_cast<double>(piece) / pieces;
    const double end = static_cast<double>(piece + 1) / pieces;
    const double middle = 0.5 * (begin + end);
    // The farthest that the bit reaches then: its base's rim, or anything nearer.
    const Pose pose = test::pose_on_way(from, to, middle);
    const Vec3 p = test::point_near(bit, {pose.tip_mm, pose.axis}, draw);
    if (bit_distance_mm(bit, pose, p) > 0.0) continue;
    const double apart_mm = (seen(p, middle) - 0.5 * (seen(p, begin) + seen(p, end))).norm();
    max_mm = std::max(max_mm, apart_mm);
    ASSERT_LE(apart_mm, 0.5 * SweepProfile::kTurningSkinMm + 1e-12) << n;
  }
  // No more pieces than needed by far: the bound is met to a good part.
  EXPECT_GT(max_mm, 0.25 * SweepProfile::kTurningSkinMm);
}

TEST(BitMotion, SurvivesOppositeAxes) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSweepSeed);
  Draw draw(kSweepSeed + 7);
  const SweepProfile bit{BitProfile({1.0, 3.0, 1.0})};
  for (int n = 0; n < 20; ++n) {
    const Pose from = draw.pose();
    const Pose to{from.tip_mm, -from.axis};
    const BitMotion motion(bit, from, to);
    EXPECT_GE(motion.piece_count(), 30U);
    for (std::size_t piece = 0; piece <= motion.piece_count(); ++piece) {
      ASSERT_NEAR(motion.pose(piece).axis.norm(), 1.0, 1e-14);
    }
    // The half turn passes the bit's whole length at right angles to both.
    const Vec3 middle = motion.pose_at(0.5).axis;
    EXPECT_NEAR(middle.dot(from.axis), 0.0, 1e-3);
    EXPECT_TRUE(is_swept(motion, from.tip_mm - 2.0 * middle));
    EXPECT_FALSE(is_swept(motion, from.tip_mm + 2.0 * middle));
    // Even one piece may do: without an answer that is right, but with one.
    EXPECT_TRUE(SweptBit(bit, from, to).contains(to.tip_mm - 2.0 * to.axis));
  }
}

}  // namespace
}  // namespace spinaltap
