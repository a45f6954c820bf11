#include "apps/report/grade_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/report/breach_map.h"
#include "apps/report/grade_output.h"
#include "core/base/error.h"
#include "core/segment/warning_metadata.h"
#include "tests/support/made_bone.h"
#include "tests/unit/apps/report/balanced_html.h"
#include "tests/unit/apps/report/times_in.h"

namespace spinaltap {
namespace {

using test::times_in;
using ::testing::HasSubstr;
using ::testing::Not;

const std::vector<double> kBands{135.0, 375.0};

GradedPath graded(double breach_mm) {
  GradedPath made;
  made.path.name = "left";
  made.path.target_mm = Vec3(0.0, -40.0, 0.0);
  made.path.screw = PedicleScrew{"", 6.5, 45.0, 4.0};
  PathGrade& grade = made.grade;
  grade.breach_mm = breach_mm;
  grade.grade = gertzbein_robbins(breach_mm);
  grade.breaches_canal = true;
  grade.breach_side = PathSide::medial;
  grade.breach_depth_mm = 18.25;
  grade.outer = {1.25, 17.5, PathSide::lateral};
  grade.canal = {-breach_mm, 18.25, PathSide::medial};
  grade.hu = 240.4;
  grade.hu_band_shares = {0.125, 0.75, 0.125};
  grade.max_thrust_n = 34.5;
  for (int n = 0; n <= 160; ++n) {
    GradeRow row;
    row.depth_mm = 0.25 * n;
    row.radius_mm = 3.25;
    row.outer_mm = 2.0;
    row.canal_mm = 1.0;
    row.is_entry = n < 20;
    row.hu = n < 4 ? std::numeric_limits<double>::quiet_NaN() : 200.0 + n;
    row.thrust_n = 0.1 * n;
    row.hu_band_shares = {0.25, 0.5, 0.25};
    grade.rows.push_back(row);
  }
  return made;
}

/// A pedicle on the patient's left and one on the right, along y.
Landmarks two_pedicles() {
  Landmarks marks;
  marks.left_pedicle.isthmus_mm = Vec3(12.0, -15.0, 0.0);
  marks.right_pedicle.isthmus_mm = Vec3(-12.0, -15.0, 0.0);
  marks.left_pedicle.width_mm = 8.76;
  marks.right_pedicle.width_mm = 4.32;
  return marks;
}

CtVolume grey_ct() {
  const GridGeometry geometry{{60, 80, 40}, Vec3(-30.0, -60.0, -20.0), Vec3::Ones(), Mat3::Identity()};
  return make_ct_volume(geometry, std::vector<std::int16_t>(geometry.voxel_count(), 300));
}

TEST(GradeReport, HasASheetWithBothSidesAndThenAllFigures) {
  Landmarks marks = two_pedicles();
  marks.warnings = {"an odd vertebra"};
  GradedPath safe = graded(0.0);
  safe.grade.is_left = false;
  safe.path.name = "right";
  safe.safe = SafeZone{.medial_mm = 1.23, .caudal_deg = 4.56};
  GradedPath bad = graded(2.5);
  bad.grade.findings = {{.is_warning = true, .words = "the head stands in the joint"}};
  const CtVolume ct = grey_ct();
  const Box3 box(Vec3(-20.0, -50.0, -10.0), Vec3(20.0, 10.0, 10.0));
  GradeReportData data{"L3", {bad, safe}, kBands, &marks, &ct, box};
  data.command = "spinaltap grade bone.vdb plan.json";
  data.date = "2026-11-24";
  data.reasons = {{"thinner for a straighter way"}};
  const std::string html = grade_report(data);
  for (const char* part : {"Left pedicle: screw 6.5 x 45 mm",
                           "Right pedicle: screw 6.5 x 45 mm",
                           "breach of 2 to below 4 mm",
                           "2.50 mm into canal, medial",
                           "lateral, at 17.5 mm of depth",
                           "240",
                           "75.0",
                           "135 to 375 HU",
                           "34.5",
                           "an odd vertebra",
                           "not a medical device",
                           "8.8",
                           "1.2 mm",
                           "4.6°",
                           "Convergence",
                           "Inclination",
                           "the head stands in the joint",
                           "thinner for a straighter way",
                           "2026-11-24",
                           "spinaltap grade bone.vdb plan.json",
                           "Isthmus, 15.0 mm",
                           "Tip, 40.0 mm",
                           ">breach<"}) {
    EXPECT_THAT(html, HasSubstr(part));
  }
  EXPECT_EQ(times_in(html, "<section class=\"sheet\">"), 1U);
  EXPECT_LT(html.find("Right pedicle:"), html.find("Left pedicle:")) << "as on an axial slice";
  EXPECT_EQ(times_in(html, "<svg class=\"plot\""), 8U) << "clearances on the sheet; three further plots of each path";
  EXPECT_EQ(times_in(html, "aria-label=\"clearance over"), 2U) << "no plot twice";
  EXPECT_EQ(times_in(html, "data:image/png"), 10U) << "five slices of each path";
  EXPECT_EQ(times_in(html, "<li class=\"warning\">"), 1U);
  EXPECT_THAT(html, Not(HasSubstr("http")));
  EXPECT_THAT(html, Not(HasSubstr("<script")));
  test::expect_balanced(test::without_pictures(html));
}

TEST(GradeReport, ShowsTheIsthmusOfAPedicleWithoutAPath) {
  const Landmarks marks = two_pedicles();
  const CtVolume ct = grey_ct();
  GradeReportData data{"T6", {}, kBands, &marks, &ct, Box3(Vec3(-20.0, -50.0, -10.0), Vec3(20.0, 10.0, 10.0))};
  data.missing = {{false, "too narrow by 2 mm", PedicleScrew{"", 3.5, 25.0, 4.0}}};
  const std::string html = grade_report(data);
  for (const char* part : {"Right pedicle", "no path", "too narrow by 2 mm", ">4.3 mm<", "3.5", "at its isthmus"}) {
    EXPECT_THAT(html, HasSubstr(part));
  }
  EXPECT_EQ(times_in(html, "data:image/png"), 2U);
  test::expect_balanced(test::without_pictures(html));
  data.landmarks = nullptr;
  EXPECT_THROW(grade_report(data), Error);
}

TEST(GradeReport, SaysAboveAllThatTheBoneIsSuspect) {
  const auto ball = [](const Vec3& p_mm) { return p_mm.norm() - 8.0; };
  const auto grids = std::make_shared<detail::BoneGrids>(
      test::made_bone(ball, Box3(Vec3::Constant(-10.0), Vec3::Constant(10.0)), 0.5).grids());
  add_warnings({{"a rib may have stayed on", "a cut is a guess"}, 0.77}, grids->metadata);
  const Bone bone{BoneModel(grids)};
  GradeReportData data{"T1", {graded(0.0)}, kBands, nullptr, nullptr, {}};
  data.bone = &bone;
  const std::string html = grade_report(data);
  EXPECT_THAT(html, HasSubstr("This bone is SUSPECT, look at it before its paths: a rib may have stayed on; a cut is"));
  EXPECT_LT(html.find("SUSPECT"), html.find("Left pedicle:"));
}

TEST(GradeReport, WarnsWhereTheCtIsTooCoarseToTellABreach) {
  GradedPath coarse = graded(0.0);
  coarse.grade.canal = {3.0, 20.0, PathSide::medial};
  coarse.surface = CtSurfaceError{.noise_part_mm = 0.9};  // 1.25 mm of clearance is -0.51 to 3.01 mm
  EXPECT_TRUE(hides_breach(coarse));
  const std::string html = grade_report({"L3", {coarse}, kBands, nullptr, nullptr, {}});
  EXPECT_THAT(html, HasSubstr("<li class=\"warning\">Surface found to 0.90 mm"));
  EXPECT_THAT(html, HasSubstr("a breach may hide in the CT&#39;s error"));
  coarse.surface->noise_part_mm = 0.3;
  EXPECT_FALSE(hides_breach(coarse));
  GradedPath breaching = graded(1.0);
  breaching.surface = CtSurfaceError{.noise_part_mm = 0.9};
  EXPECT_FALSE(hides_breach(breaching)) << "it is told already";
}

TEST(GradeReport, NamesTheErrorsOfItsProbabilitiesAsPeopleDo) {
  GradedPath placed = graded(0.0);
  placed.placed.emplace();
  placed.placed->errors.name = "robot_726";
  placed.placed->errors.title = "Robot, 726 screws, lumbosacral";
  placed.placed->map.shift_mm = {{-1.0, 0.0, 1.0}, std::vector<double>(9, -0.5)};
  const std::string map = breach_map_svg(*placed.placed);
  EXPECT_THAT(map, HasSubstr(">Errors: Robot, 726 screws,"));
  EXPECT_THAT(map, HasSubstr("lumbosacral<"));
  EXPECT_THAT(map, Not(HasSubstr("robot_726")));
  placed.placed->errors.title.clear();
  EXPECT_THAT(breach_map_svg(*placed.placed), HasSubstr("Errors: robot_726"));
}

TEST(GradeReport, CutsTheClearancesWhereDecisionsLie) {
  GradedPath safe = graded(0.0);
  EXPECT_EQ(clearance_plot(safe).y_low, -1.0);
  EXPECT_EQ(clearance_plot(safe).y_high, 5.0);
  safe.grade.rows[100].canal_mm = -2.5;
  EXPECT_EQ(clearance_plot(safe).y_low, -3.0);
}

TEST(GradeReport, EscapesNamesFromFiles) {
  GradedPath attack = graded(0.0);
  attack.path.name = "<script>alert(1)</script>";
  EXPECT_THAT(grade_report({"L3", {attack}, kBands, nullptr, nullptr, {}}), Not(HasSubstr("<script")));
}

TEST(GradeReport, LeavesOutWallsThatAreNotThere) {
  GradedPath alone = graded(0.0);
  alone.grade.canal = {};
  alone.grade.outer = {};
  alone.grade.hu = std::numeric_limits<double>::quiet_NaN();
  for (GradeRow& row : alone.grade.rows) row.canal_mm = std::numeric_limits<double>::infinity();
  const std::string html = grade_report({"L3", {alone}, kBands, nullptr, nullptr, {}});
  EXPECT_THAT(html, Not(HasSubstr("min clearance")));
  EXPECT_THAT(html, Not(HasSubstr(">inf")));
  EXPECT_THAT(html, Not(HasSubstr(">nan")));
}

TEST(GradeReport, RejectsToReportNothing) {
  EXPECT_THROW(grade_report({"L3", {}, kBands, nullptr, nullptr, {}}), Error);
}

TEST(GradeOutput, WritesWhatIsNotFiniteAsNullAndAsAnEmptyField) {
  GradedPath alone = graded(0.0);
  alone.path.name = "left, \"upper\"";
  alone.grade.canal = {};
  alone.grade.rows[0].canal_mm = std::numeric_limits<double>::infinity();
  const Json json = to_json(alone, kBands, true);
  EXPECT_TRUE(json["canal"].is_null());
  EXPECT_TRUE(json["breach"].is_null());
  EXPECT_TRUE(json["rows"][0]["hu"].is_null());
  EXPECT_TRUE(json["rows"][0]["clearance_canal_mm"].is_null());
  EXPECT_EQ(json["rows"].size(), 161U);
  EXPECT_EQ(json["grade"], "A");
  EXPECT_FALSE(to_json(alone, kBands, false).contains("rows"));
  const std::string csv = grades_csv({alone}, kBands);
  EXPECT_THAT(csv, HasSubstr("\n\"left, \"\"upper\"\"\",0,3.25,2,lateral,,medial,0,1,,0,0,0,0.25,0.5,0.25\n"));
  EXPECT_EQ(times_in(csv, "\n"), 162U);
}

TEST(GradeOutput, NamesTheBandsAndTheToolAndTheBreach) {
  EXPECT_EQ(band_names(kBands), (std::vector<std::string>{"below 135 HU", "135 to 375 HU", "375 HU and above"}));
  EXPECT_EQ(band_names({}).size(), 1U);
  EXPECT_EQ(tool_of(graded(0.0).path), "screw 6.5 x 45 mm");
  EXPECT_EQ(tool_of(DrillPath()), "bit of 3 mm");
  EXPECT_EQ(breach_of(graded(1.0).grade), "canal, medial");
  EXPECT_EQ(breach_of(graded(0.0).grade), "");
  const std::string table = grades_table({graded(2.5)}, kBands);
  for (const char* part : {"2.50", "canal, medial", "-2.50", "18.2", "75.0", "34.5"}) {
    EXPECT_THAT(table, HasSubstr(part));
  }
}

}  // namespace
}  // namespace spinaltap
