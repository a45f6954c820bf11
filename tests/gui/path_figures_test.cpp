#include "apps/spinaltap-planner/figures/path_figures.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/phantom/vertebra_ground_truth.h"
#include "core/segment/warning_metadata.h"
#include "tests/gui/phantom_bone.h"
#include "tests/support/temporary_folder.h"
#include "vdb/bake/bake.h"

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

/// The phantom's bone, with what its maker says against it or its CT.
std::shared_ptr<const OpenedBone> doubted(const LevelWarnings& warnings, const std::vector<std::string>& of_ct) {
  const test::TemporaryFolder folder;
  std::map<std::string, std::string> metadata;
  add_warnings(warnings, metadata);
  add_input_warnings(of_ct, metadata);
  write_bone(bake_solid(Vertebra(), {.voxel_mm = 1.0}, 60.0, {}, metadata), folder.path() / "bone.vdb");
  return open_bone(folder.path() / "bone.vdb");
}

TEST(PathFigures, SayWhereAGoodGradeLeansOnWhatMayBeWrong) {
  const DrillPath path = test::phantom_paths().front();
  const PathGrader grader;
  EXPECT_EQ(grader.figures(*test::phantom_bone(), path).doubt, "");
  const std::vector<std::string> filled{"2 slices are missing between 12 and 15 mm: interpolated"};
  EXPECT_EQ(grader.figures(*doubted({{"no gap shows"}, 0.1}, filled), path).doubt, "the CT");
  const LevelWarnings cut{{"the body goes on beyond the CT: its lower end is not in it"}, 0.3};
  EXPECT_EQ(grader.figures(*doubted(cut, filled), path).doubt, "the CT and the bone");
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
  path.entry_mm -= 1.5 * path.direction();
  EXPECT_TRUE(warns(grader.figures(bone, path), WarningLevel::caution, "off the bone's surface"));
  path.entry_mm -= 4.5 * path.direction();
  EXPECT_TRUE(warns(grader.figures(bone, path), WarningLevel::danger, "mm off the bone's surface"));

  path.entry_mm += Vec3(300.0, 0.0, 0.0);
  path.target_mm += Vec3(300.0, 0.0, 0.0);
  figures = grader.figures(bone, path);
  EXPECT_FALSE(figures.is_graded);
  EXPECT_TRUE(warns(figures, WarningLevel::danger, "misses the bone"));
}

TEST(PathFigures, TellWhatTheInstrumentBehindTheEntryMeets) {
  const OpenedBone& bone = *test::phantom_bone();
  DrillPath path = test::phantom_paths().front();
  // A screw of half the path's length, its tip at the target, has its head in the pedicle.
  path.screw = PedicleScrew{"short", 4.5, 0.5 * path.length_mm(), 4.0};
  const PathFigures figures = PathGrader().figures(bone, path);
  ASSERT_TRUE(figures.is_graded);
  EXPECT_LT(figures.graded.grade.instrument.head_clearance_mm, -kTouchMm);
  EXPECT_TRUE(warns(figures, WarningLevel::note, "head") || warns(figures, WarningLevel::caution, "head"));
  // Every finding is there once, a breach as that of its wall.
  for (const Finding& finding : figures.graded.grade.findings) {
    const bool is_breach = finding.part == InstrumentPart::tool && finding.words.starts_with("the screw stands");
    const auto tells = [&](const PathWarning& warning) { return warning.text == finding.words; };
    EXPECT_EQ(std::count_if(figures.warnings.begin(), figures.warnings.end(), tells), is_breach ? 0 : 1)
        << finding.words;
  }
}

TEST(PathFigures, HaveReasonsOnlyAsLongAsThePathIsTheSuggestedOne) {
  const OpenedBone& bone = *test::phantom_bone();
  SuggestedPath suggested;
  suggested.path = test::phantom_paths().front();
  suggested.path.screw = PedicleScrew{"6.5 x 45", 6.5, 45.0, 4.0};
  suggested.technique = Technique::cortical;
  suggested.reasons = {"the only one"};
  PathFigures figures = PathGrader().figures(bone, suggested.path);
  add_reasons({&suggested, 1}, figures);
  EXPECT_EQ(figures.technique, Technique::cortical);
  EXPECT_THAT(figures.reasons, testing::ElementsAre("the only one"));
  DrillPath moved = suggested.path;
  moved.target_mm.z() += 0.1;
  DrillPath thinner = suggested.path;
  thinner.screw->diameter_mm = 5.5;
  DrillPath bare = suggested.path;
  bare.screw.reset();
  for (const DrillPath& other : {moved, thinner, bare}) {
    figures = PathGrader().figures(bone, other);
    add_reasons({&suggested, 1}, figures);
    EXPECT_FALSE(figures.technique.has_value());
    EXPECT_TRUE(figures.reasons.empty());
  }
}

}  // namespace
}  // namespace spinaltap
