// Compiled with optimisation: long loops of its own.

#include "core/grading/screw_breach.h"
#include "core/anatomy/landmarks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <span>

#include "core/base/error.h"
#include "core/points/material.h"
#include "core/uncertainty/placement_errors.h"
#include "tests/support/nan.h"
#include "tests/support/planning_bones.h"
#include "tests/support/test_kind.h"

namespace spinaltap {
namespace {

/// Screws of all kinds, through pedicles, off them, into the canal and away from bone, graded as grade_path() does.
void expect_grades_of_paths(const WallDistance& walls, const DrillPath& plan, double mm, double degrees, int count) {
  const HuSampler hu = [](std::span<const Vec3> points_mm, std::span<float> values) {
    std::fill_n(values.begin(), points_mm.size(), 200.0F);
  };
  const ScrewGrader grader(walls);
  const PlacementErrors errors = plain_errors(mm, degrees);
  const ErrorFrame frame = error_frame(walls.landmarks(), plan);
  int breaches = 0;
  for (int n = 0; n < count; ++n) {
    const DrillPath path = erred_path(plan, frame, draw_error(errors, 7, static_cast<std::uint32_t>(n)));
    const PathGrade slow = grade_path(walls, hu, Material{}, path);
    const ScrewBreach fast = grader.grade(path);
    ASSERT_EQ(fast.breach_mm, slow.breach_mm) << n;
    EXPECT_EQ(fast.grade(), slow.grade) << n;
    EXPECT_EQ(std::max(fast.outer_mm, fast.canal_mm), slow.breach_mm) << n;
    EXPECT_EQ(fast.side_breach_mm, slow.side_breach_mm) << n;
    const ScrewBreach faster = grader.grade(path, ScrewSides::anterior);
    EXPECT_EQ(faster.breach_mm, slow.breach_mm) << n;
    EXPECT_EQ(faster.side_breach_mm.back(), slow.side_breach_mm.back()) << n;  // anterior
    if (!(slow.breach_mm > 0.0)) continue;
    ++breaches;
    EXPECT_EQ(fast.depth_mm, slow.breach_depth_mm) << n;
    EXPECT_EQ(fast.side, slow.breach_side) << n;
    EXPECT_EQ(fast.is_canal, slow.breaches_canal) << n;
  }
  EXPECT_GT(breaches, count / 50);
  EXPECT_LT(breaches, count);
}

SLOW_TESTS("ScrewGrader.GradesThePhantomsScrewsAsPathsAre");

TEST(ScrewGrader, GradesABlocksScrewsAsPathsAre) {
  const test::Block block;
  const WallDistance walls(block.bone(), block.landmarks());
  constexpr double kRadiusMm = 3.0;
  for (const double beside_mm : {1.0, -2.0}) {
    const double x_mm = test::Block::kHalfWidthMm - kRadiusMm - beside_mm;
    DrillPath plan{"", Vec3(x_mm, test::Block::kHalfDepthMm, 0.0), Vec3(x_mm, -12.0, 0.0), {}};
    plan.screw = PedicleScrew{"", 2.0 * kRadiusMm, 45.0, 4.0};
    expect_grades_of_paths(walls, plan, 2.5, 5.0, 60);
  }
}

TEST(ScrewGrader, GradesThePhantomsScrewsAsPathsAre) {
  const test::PhantomBone phantom;
  const WallDistance walls(phantom.bone, phantom.landmarks);
  for (const PedicleLandmarks& pedicle : {phantom.landmarks.left_pedicle, phantom.landmarks.right_pedicle}) {
    DrillPath plan{"", pedicle.isthmus_mm - 18.0 * pedicle.axis, pedicle.isthmus_mm + 27.0 * pedicle.axis, {}};
    expect_grades_of_paths(walls, plan, 2.5, 5.0, 50);
    plan.screw = PedicleScrew{"", 6.5, 45.0, 4.0};
    expect_grades_of_paths(walls, plan, 1.5, 3.0, 200);
    expect_grades_of_paths(walls, plan, 4.0, 8.0, 200);
  }
}

TEST(ScrewGrader, RejectsOptionsAndPathsWithoutSense) {
  const test::Block block;
  const WallDistance walls(block.bone(), block.landmarks());
  EXPECT_THROW(ScrewGrader(walls, {.step_mm = test::kNan}), Error);
  EXPECT_THROW(ScrewGrader(walls, {.ring_points = 1}), Error);
  const ScrewGrader grader(walls);
  EXPECT_THROW(grader.grade({"", Vec3::Zero(), Vec3::Zero(), {}}), Error);
  EXPECT_THROW(grader.grade({"", Vec3::Zero(), Vec3::Constant(test::kNan), {}}), Error);
  DrillPath cut{"", Vec3(18.0, 20.0, 0.0), Vec3(18.0, 0.0, 0.0), {}};
  cut.bit = plate_bit(10.0, 1.0, 40.0);
  EXPECT_THROW(grader.grade(cut), Error);
}

}  // namespace
}  // namespace spinaltap
