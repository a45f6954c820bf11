#include "core/grading/path_doubt.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/base/error.h"
#include "core/grading/grade.h"

namespace spinaltap {
namespace {

using testing::HasSubstr;

constexpr double kRadiusMm = 3.0;

/// Forward along -y at a height.
DrillPath path_at(double z_mm) {
  DrillPath path{"left", Vec3(0.0, 20.0, z_mm), Vec3(0.0, -20.0, z_mm), {}};
  path.screw = PedicleScrew{"", 2.0 * kRadiusMm, 40.0, 4.0};
  return path;
}

TEST(PathDoubts, TellHowMuchOfAPathLiesInMadeUpSlices) {
  const DoubtfulBone bone{MadeUpSlices{Vec3::UnitZ(), {{10.0, 12.0}, {30.0, 31.0}}}};
  EXPECT_TRUE(path_doubts(bone, path_at(0.0)).empty());
  EXPECT_TRUE(path_doubts(bone, path_at(10.0 - kRadiusMm - 0.01)).empty());
  // The screw beside its axis lies in them too.
  const std::vector<PathDoubt> all = path_doubts(bone, path_at(10.0 - kRadiusMm + 0.01));
  ASSERT_EQ(all.size(), 1U);
  EXPECT_NEAR(all[0].length_mm, 40.0, 1e-9);
  EXPECT_EQ(all[0].kind, PathDoubt::Kind::made_up_slices);
  EXPECT_EQ(in_words(all[0]), "40.0 mm of it lie in slices that were made up");
  // Across the slices, from z = 20 to z = -20: the axis is 2 mm in them, and no section leans.
  DrillPath across = path_at(0.0);
  across.entry_mm = Vec3(0.0, 0.0, 20.0);
  across.target_mm = Vec3(0.0, 0.0, -20.0);
  const std::vector<PathDoubt> some = path_doubts(bone, across);
  ASSERT_EQ(some.size(), 1U);
  EXPECT_NEAR(some[0].length_mm, 2.0, 0.26);
  EXPECT_NEAR(some[0].depth_mm, 8.0, 0.26);
}

TEST(PathDoubts, TellHowMuchOfAPathRunsInBoneThatMayBeAnothers) {
  // Voxels stand for the bone within 1 mm; this one is 2 mm beside the axis, in the screw.
  const DoubtfulBone bone{std::nullopt, {Vec3(2.0, 0.0, 0.0)}};
  const std::vector<PathDoubt> doubts = path_doubts(bone, path_at(0.0));
  ASSERT_EQ(doubts.size(), 1U);
  EXPECT_EQ(doubts[0].kind, PathDoubt::Kind::unsure_bone);
  EXPECT_NEAR(doubts[0].length_mm, 2.0 * std::sqrt(16.0 - 4.0), 0.26);
  EXPECT_NEAR(doubts[0].depth_mm, 20.0 - std::sqrt(16.0 - 4.0), 0.26);
  EXPECT_NEAR(doubts[0].without_mm, 2.0 - kRadiusMm - 1.0, 0.01);
  // Half of a millimetre would stand out: beside a rib as on any vertebra.
  EXPECT_TRUE(path_doubts({std::nullopt, {Vec3(kRadiusMm + 0.5, 0.0, 0.0)}}, path_at(0.0)).empty());
  EXPECT_TRUE(path_doubts(bone, path_at(kRadiusMm + 1.01 + 0.5)).empty());
  EXPECT_TRUE(path_doubts({}, path_at(0.0)).empty());
  DrillPath no_path = path_at(0.0);
  no_path.target_mm = no_path.entry_mm;
  EXPECT_THROW(path_doubts(bone, no_path), Error);
}

TEST(PathDoubts, TakeAGradeItsPlainLetterAndAreWarnings) {
  PathGrade grade;
  grade.findings = {{.is_warning = true, .words = "first"}, {.is_warning = false, .words = "note"}};
  note_doubts({}, path_at(0.0), grade);
  EXPECT_EQ(grade_in_words(grade), "A");
  ASSERT_EQ(grade.findings.size(), 2U);
  note_doubts({MadeUpSlices{Vec3::UnitZ(), {{-1.0, 1.0}}}, {Vec3(0.0, 20.0, 0.0)}}, path_at(0.0), grade);
  EXPECT_EQ(grade.grade, Grade::A);
  EXPECT_THAT(grade_in_words(grade), HasSubstr("A, but 40.0 mm of it lie in slices that were made up, and "));
  EXPECT_THAT(grade_in_words(grade), HasSubstr(" mm of it run in bone that may be another's"));
  ASSERT_EQ(grade.findings.size(), 4U);
  EXPECT_THAT(grade.findings[1].words, HasSubstr("nothing was scanned there"));
  // The middle of the first step is an eighth of a millimetre behind the entry.
  EXPECT_THAT(grade.findings[2].words, HasSubstr("the tool stands up to 3.9 mm out of this one"));
  EXPECT_TRUE(grade.findings[2].is_warning);
  EXPECT_EQ(grade.findings[3].words, "note");
}

}  // namespace
}  // namespace spinaltap
