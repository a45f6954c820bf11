// Compiled with optimisation: long loops of its own.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "core/grading/grade.h"
#include "core/plan/suggest.h"
#include "core/session/choose_engine.h"
#include "core/session/operator/force_controlled.h"
#include "core/session/operator/path_motion.h"
#include "core/session/session_setup.h"
#include "core/session/tool_clearance.h"
#include "core/uncertainty/placement_errors.h"
#include "tests/support/planning_bones.h"
#include "tests/support/test_kind.h"

namespace spinaltap {
namespace {

constexpr double kBurrMm = 1.5;  // radius

/// A ball's way in the block, beside its canal of 8 mm radius, from the back forward at x, bulging to `via_x_mm`.
DrillPath path_beside_canal(double x_mm, double via_x_mm) {
  DrillPath path{"curve", {x_mm, test::Block::kHalfDepthMm, 1.0}, {x_mm, -12.0, 1.0}, steerable_head()};
  path.via_mm = {{via_x_mm, 4.0, 1.0}};
  return path;
}

const WallDistance& block_walls() {
  static const test::Block block;
  static const WallDistance walls(block.bone(), block.landmarks());
  return walls;
}

double canal_mm(const Vec3& p_mm) { return std::hypot(p_mm.x(), p_mm.y()) - test::Block::kHoleMm; }

PathGrade block_grade(const DrillPath& path) {
  const auto hu_of_300 = [](std::span<const Vec3>, std::span<float> hu) { std::fill(hu.begin(), hu.end(), 300.0F); };
  return grade_path(block_walls(), hu_of_300, Material(), path);
}

/// The canal's distance from a round section across the path, along it by places of the curve: all of it lies in a
/// plane that holds z, in which the section is a line from -r to r.
double section_to_canal_mm(const PathCurve& curve, double depth_mm, double radius_mm) {
  const Vec3 centre_mm = curve.at_mm(depth_mm), along = curve.direction_at(depth_mm);
  const Vec3 across(-along.y(), along.x(), 0.0);
  const double foot_mm = std::clamp(-centre_mm.dot(across), -radius_mm, radius_mm);
  return canal_mm(centre_mm + foot_mm * across);
}

SLOW_TESTS("CurvedPath.HasTheClearancesOfItsBallWhereThatIs");

TEST(CurvedPath, IsGradedByItsCurveWhereItsChordBreaches) {
  const DrillPath path = path_beside_canal(7.5, 12.5);
  DrillPath chord = path;
  chord.via_mm.clear();
  const PathGrade straight = block_grade(chord);
  EXPECT_EQ(straight.grade, Grade::C);
  EXPECT_NEAR(straight.breach_mm, 8.0 + kBurrMm - 7.5, 0.02);
  const PathGrade graded = block_grade(path);
  EXPECT_EQ(graded.grade, Grade::A);
  EXPECT_EQ(graded.breach_mm, 0.0);
  const PathCurve curve(path);
  double nearest_mm = std::numeric_limits<double>::infinity();
  int compared = 0;
  for (const GradeRow& row : graded.rows) {
    const double expected_mm = section_to_canal_mm(curve, row.depth_mm, row.radius_mm);
    nearest_mm = std::min(nearest_mm, expected_mm);
    if (expected_mm < 3.0) ++compared;
    if (expected_mm < 3.0) {
      EXPECT_NEAR(row.canal_mm, expected_mm, 0.02) << row.depth_mm;
    }
  }
  EXPECT_GT(compared, 30);
  EXPECT_NEAR(graded.canal.clearance_mm, nearest_mm, 0.02);
  EXPECT_GT(nearest_mm, 0.5);
  EXPECT_NEAR(graded.rows.back().depth_mm, curve.length_mm(), 1e-9);
}

TEST(CurvedPath, IsGradedByItsCurveWhereItsChordStaysInBone) {
  const DrillPath path = path_beside_canal(12.0, 7.5);
  DrillPath chord = path;
  chord.via_mm.clear();
  EXPECT_EQ(block_grade(chord).grade, Grade::A);
  const PathGrade graded = block_grade(path);
  const PathCurve curve(path);
  double breach_mm = 0.0, depth_mm = 0.0;
  for (double s = 0.0; s <= curve.length_mm(); s += 0.01) {
    const double one_mm = -section_to_canal_mm(curve, s, kBurrMm);
    if (one_mm > breach_mm) depth_mm = s;
    breach_mm = std::max(breach_mm, one_mm);
  }
  ASSERT_GT(breach_mm, 0.5);
  // Rows are 0.25 mm apart: beside the deepest place the breach is at most 0.125² / (2 x 8) mm less.
  EXPECT_NEAR(graded.breach_mm, breach_mm, 0.02);
  EXPECT_EQ(graded.grade, gertzbein_robbins(breach_mm));
  EXPECT_TRUE(graded.breaches_canal);
  EXPECT_EQ(graded.breach_side, PathSide::medial);
  EXPECT_NEAR(graded.breach_depth_mm, depth_mm, 1.0);
  EXPECT_NEAR(spinaltap::breach_mm(block_walls(), path), graded.breach_mm, 1e-9);
}

TEST(CurvedPath, HasTheClearancesOfItsBallWhereThatIs) {
  const DrillPath path = path_beside_canal(7.5, 12.5);
  const PathCurve curve(path);
  const ClearanceField field(block_walls(), path);
  const BitProfile ball(path.bit);
  for (double s = 4.0; s < curve.length_mm(); s += 0.5) {
    const Pose pose = curve.pose_at(s);
    const Vec3 centre_mm = pose.tip_mm - kBurrMm * pose.axis;
    const Clearance found = field.of(ball, pose);
    EXPECT_NEAR(found.canal_mm, canal_mm(centre_mm) - kBurrMm, 0.05) << s;
    const double outer_mm = (test::Block::half() - centre_mm.cwiseAbs()).minCoeff() - kBurrMm;
    if (s - 2.0 * kBurrMm > field.entry_end_mm() && outer_mm < 8.0) {
      EXPECT_NEAR(found.outer_mm, outer_mm, 0.05) << s;
    }
  }
  // Ahead of the target the way goes straight on: a ball whose foremost place is at the front wall.
  const double on_mm = (curve.at_mm(curve.length_mm()).y() + test::Block::kHalfDepthMm - 2.0) /
                       -curve.direction_at(curve.length_mm()).y();
  const Pose beyond = curve.pose_at(curve.length_mm() + on_mm);
  const Vec3 centre_mm = beyond.tip_mm - kBurrMm * beyond.axis;
  EXPECT_NEAR(field.of(ball, beyond).outer_mm, centre_mm.y() + test::Block::kHalfDepthMm - kBurrMm, 0.05);
}

TEST(CurvedPath, IsGoneByOperatorsInStepsOfTheirFeed) {
  const DrillPath path = path_beside_canal(7.5, 12.5);
  const PathCurve curve(path);
  const double step_mm = 0.02;
  const PathMotion motion(path, in_steps_of(step_mm, {.lead_in_mm = 2.0}));
  ASSERT_EQ(motion.cycle_count(), static_cast<std::size_t>(std::ceil((curve.length_mm() + 2.0) / step_mm)));
  for (std::size_t n = 0; n <= motion.cycle_count(); ++n) {
    const Pose pose = motion.pose(n);
    const double depth_mm = std::min(-2.0 + step_mm * static_cast<double>(n), curve.length_mm());
    ASSERT_NEAR(pose.axis.norm(), 1.0, 1e-12);
    ASSERT_LT((pose.tip_mm - curve.at_mm(depth_mm)).norm(), 1e-6) << n;
    ASSERT_LT((pose.axis - curve.direction_at(depth_mm)).norm(), 1e-6) << n;
  }
  EXPECT_LT((motion.pose(motion.cycle_count()).tip_mm - path.target_mm).norm(), 1e-9);
  EXPECT_LT((motion.pose(0).tip_mm - (path.entry_mm - 2.0 * curve.direction_at(0.0))).norm(), 1e-9);

  const GuidedBit beside(path, {.lead_in_mm = 1.0, .offset_mm = 0.8, .tilt_deg = 5.0});
  for (double depth_mm = -1.0; depth_mm < curve.length_mm(); depth_mm += 0.1) {
    const Pose pose = beside.at(depth_mm);
    const double off_line_mm = std::sin(5.0 * kDegree) * (depth_mm - 0.5 * curve.length_mm());
    const double along_mm = curve.nearest_mm(pose.tip_mm);
    ASSERT_NEAR((pose.tip_mm - curve.at_mm(along_mm)).norm(), std::hypot(0.8, off_line_mm), 1e-6) << depth_mm;
    ASSERT_NEAR(pose.axis.dot(curve.direction_at(along_mm)), std::cos(5.0 * kDegree), 1e-9) << depth_mm;
  }
  EXPECT_THROW(GuidedBit(path, {.offset_mm = 40.0}), Error);
}

TEST(CurvedPath, IsGoneByOneWhoPushesAsFarAsTheTarget) {
  const DrillPath path = path_beside_canal(7.5, 12.5);
  const PathCurve curve(path);
  ForceControlled surgeon(path, {.approach_mm_s = 20.0});
  Pose last;
  std::optional<ToolInput> input = surgeon.next({});
  double max_step_mm = 0.0;
  for (; input; input = surgeon.next({})) {
    const double along_mm = curve.nearest_mm(input->pose.tip_mm);
    ASSERT_LT((input->pose.tip_mm - curve.at_mm(along_mm)).norm(), 1e-6);
    ASSERT_NEAR(along_mm, surgeon.depth_mm(), 1e-5);
    if (last.tip_mm != Vec3::Zero()) max_step_mm = std::max(max_step_mm, (input->pose.tip_mm - last.tip_mm).norm());
    last = input->pose;
  }
  EXPECT_NEAR(max_step_mm, 0.02, 1e-6);
  EXPECT_NEAR(curve.nearest_mm(last.tip_mm), curve.length_mm(), 0.05);
}

TEST(CurvedPath, LiesInItsRegionAndInItsCylinder) {
  const DrillPath path = path_beside_canal(7.5, 12.5);
  const PathCurve curve(path);
  const Box3 region_mm = region_around(path, 3.0, 2.0);
  const PointVolumeOptions options{.radius_mm = 2.0, .spacing_mm = 0.25, .lead_in_mm = 3.0};
  const PointVolume volume(path, options);
  const double radius_mm = (volume.pattern().ring_count() - 1) * options.spacing_mm;
  for (double s = -3.0; s <= curve.length_mm(); s += 0.05) {
    EXPECT_GT((curve.at_mm(s) - region_mm.min()).minCoeff(), 1.9);
    EXPECT_GT((region_mm.max() - curve.at_mm(s)).minCoeff(), 1.9);
    for (const double turn : {0.0, 1.0, 2.0, 3.0, 4.0, 5.0}) {
      const Vec3 at = volume.frame().to_path(curve.to_patient({1.75 * std::cos(turn), 1.75 * std::sin(turn), s}));
      ASSERT_LE(std::hypot(at.x(), at.y()), radius_mm + 1e-9) << s;
      ASSERT_GE(at.z(), -0.5 * options.spacing_mm) << s;
      ASSERT_LE(at.z(), (volume.disc_count() - 0.5) * options.spacing_mm) << s;
    }
  }
}

TEST(CurvedPath, IsRejectedByWhatIsMadeForStraightOnes) {
  const DrillPath path = path_beside_canal(7.5, 12.5);
  EXPECT_THROW(error_frame(block_walls().landmarks(), path), Error);
  EXPECT_THROW(safe_zone(block_walls(), path), Error);
}

TEST(CurvedPath, TakesLeavesWhereItTurnsFarFromItsChord) {
  SessionSetup setup;
  setup.path = path_beside_canal(7.5, 12.5);
  EXPECT_GT(PathCurve(setup.path).max_tilt_deg(), 15.0);
  EXPECT_EQ(chosen_engine(setup, {.trembles = false}), EngineKind::leaf);
  setup.path.via_mm = {{8.0, 4.0, 1.0}};
  EXPECT_EQ(chosen_engine(setup, {.trembles = false}), EngineKind::ring);
}

}  // namespace
}  // namespace spinaltap
