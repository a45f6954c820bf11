#include "apps/spinaltap-planner/figures/path_figures.h"

#include <gmock/gmock.h>

#include "core/phantom/vertebra_ground_truth.h"
#include "tests/gui/phantom_bone.h"

namespace spinaltap {
namespace {

bool warns(const PathFigures& figures, WarningLevel level, const std::string& words) {
  for (const PathWarning& warning : figures.warnings) {
    if (warning.level == level && warning.text.find(words) != std::string::npos) return true;
  }
  return false;
}

TEST(PathFigures, OfAPathAlongThePediclesAxisAreThePhantoms) {
  const DrillPath path = test::phantom_paths().front();
  const PathFigures figures = PathGrader().figures(*test::phantom_bone(), path);
  ASSERT_TRUE(figures.is_graded);
  EXPECT_EQ(figures.graded.grade.grade, Grade::A);
  EXPECT_TRUE(figures.graded.grade.is_left);
  // The anatomy's own angle between the pedicle's axis and the sagittal plane; landmarks are right to 2 degrees.
  EXPECT_NEAR(figures.angles.convergence_deg, VertebraAnatomy().pedicle.convergence_deg, 2.0);
  EXPECT_TRUE(figures.angles_are_the_vertebras);
  EXPECT_FALSE(warns(figures, WarningLevel::danger, ""));
}

TEST(PathFigures, SayWhatIsWrongWithABadPath) {
  const OpenedBone& bone = *test::phantom_bone();
  const PathGrader grader;
  DrillPath path = test::phantom_paths().front();
  path.screw = PedicleScrew{"as wide as the pedicle", 2.0 * bone.landmarks()->left_pedicle.width_mm, 45.0, 4.0};
  PathFigures figures = grader.figures(bone, path);
  EXPECT_TRUE(warns(figures, WarningLevel::danger, "breaches"));
  EXPECT_TRUE(warns(figures, WarningLevel::caution, "200 % of the pedicle's width"));
  EXPECT_EQ(figures.warnings.front().level, WarningLevel::danger);  // the worst first

  path = test::phantom_paths().front();
  path.entry_mm -= 6.0 * path.direction();
  EXPECT_TRUE(warns(grader.figures(bone, path), WarningLevel::caution, "off the bone's surface"));

  path.entry_mm += Vec3(300.0, 0.0, 0.0);
  path.target_mm += Vec3(300.0, 0.0, 0.0);
  figures = grader.figures(bone, path);
  EXPECT_FALSE(figures.is_graded);
  EXPECT_TRUE(warns(figures, WarningLevel::danger, "misses the bone"));
}

}  // namespace
}  // namespace spinaltap
