#include "apps/report/grade_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "apps/report/grade_output.h"
#include "core/base/error.h"
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

TEST(GradeReport, ShowsGradeBreachApproachesAndFourPlotsOfEachPath) {
  Landmarks odd;
  odd.warnings = {"an odd vertebra"};
  odd.left_pedicle.width_mm = 8.76;
  GradedPath safe = graded(0.0);
  safe.safe = SafeZone{.medial_mm = 1.23, .caudal_deg = 4.56};
  const GridGeometry geometry{{20, 60, 20}, Vec3(-10.0, -50.0, -10.0), Vec3::Ones(), Mat3::Identity()};
  const CtVolume ct = make_ct_volume(geometry, std::vector<std::int16_t>(geometry.voxel_count(), 300));
  const Box3 box(Vec3(-10.0, -50.0, -10.0), Vec3(10.0, 10.0, 10.0));
  const std::string html = grade_report({"L3", {graded(2.5), safe}, kBands, &odd, &ct, box});
  for (const char* part : {"C: breach of 2 to below 4 mm", "A: no breach", "canal, medial",
                           "lateral, at 17.5 mm of depth", "240", "75.0", "135 to 375 HU", "34.5", "an odd vertebra",
                           "not a medical device", "screw 6.5 x 45 mm", "8.8", "1.2 mm or", "or 4.6°"}) {
    EXPECT_THAT(html, HasSubstr(part));
  }
  EXPECT_EQ(times_in(html, "<svg class=\"plot\""), 8U);
  EXPECT_EQ(times_in(html, "data:image/png"), 8U) << "four slices of each path";
  EXPECT_THAT(html, Not(HasSubstr("http")));
  EXPECT_THAT(html, Not(HasSubstr("<script")));
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
  EXPECT_THAT(csv, HasSubstr("\n\"left, \"\"upper\"\"\",0,3.25,2,lateral,,medial,1,,0,0.25,0.5,0.25\n"));
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
