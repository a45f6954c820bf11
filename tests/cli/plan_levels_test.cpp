#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/files/json_file.h"
#include "core/files/plan_file.h"
#include "tests/cli/program.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

Vec3 vec3_of(const Json& json) { return {json[0].get<double>(), json[1].get<double>(), json[2].get<double>()}; }

/// Three vertebrae of a phantom's CT, by its true labels: bones of one CT, which several solids baked alone are not
/// (where two are nearer than 2 mm, each has CT numbers of its own, and a spine.vdb takes one).
class PlanLevels : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryFolder;
    const auto done = [](const std::string& arguments) {
      const test::ProgramRun made = test::run_program(arguments, folder_->path());
      if (made.exit_code != 0) trouble_ += arguments + ": " + made.errors;
    };
    done("phantom spine --spine L2-L4 --no-ribs --pixel 0.9 --size 128 --slice-step 1.2 --slice-width 1.2 --noise 5");
    done("bake spine/ct --labels spine/ground_truth_labels.nii.gz --all --voxel 0.6 --point-spacing 0.8 -o spine.vdb");
    planned_ = run("plan spine.vdb --auto --levels all --ct spine/ct --errors none -o plans --json out.json");
  }
  static void TearDownTestSuite() { delete folder_; }
  void SetUp() override { ASSERT_EQ(trouble_, ""); }

  static test::ProgramRun run(const std::string& arguments) { return test::run_program(arguments, folder_->path()); }
  static std::filesystem::path in(const std::string& name) { return folder_->path() / name; }
  static std::string text_of(const std::string& name) {
    std::ostringstream text;
    text << std::ifstream(in(name)).rdbuf();
    return text.str();
  }
  /// The true pedicle of a level, 0 for L2, on the side of a rod.
  static Json pedicle(std::size_t level, const Json& side) {
    return read_json(in("spine/ground_truth.json"))["levels"][level]["pedicles"][side.get<std::string>()];
  }

  static const test::TemporaryFolder* folder_;
  static std::string trouble_;
  static test::ProgramRun planned_;
};

constexpr std::array<const char*, 3> kLevels{"L2", "L3", "L4"};

const test::TemporaryFolder* PlanLevels::folder_ = nullptr;
std::string PlanLevels::trouble_;
test::ProgramRun PlanLevels::planned_;

TEST_F(PlanLevels, WriteAPlanAndAReportOfEach) {
  ASSERT_EQ(planned_.exit_code, 0) << planned_.errors;
  EXPECT_THAT(test::everything_in(in("plans")), testing::ElementsAre("L2.html", "L2.json", "L3.html", "L3.json",
                                                                     "L4.html", "L4.json", "files.txt", "rods.json"));
  const Json figures = read_json(in("out.json"));
  ASSERT_EQ(figures["levels"].size(), kLevels.size());
  for (std::size_t n = 0; n < kLevels.size(); ++n) {
    const std::string name = kLevels[n];
    EXPECT_EQ(figures["levels"][n]["level"], name);
    const std::vector<DrillPath> paths = read_plan(in("plans/" + name + ".json"));
    ASSERT_EQ(paths.size(), 2U) << name;
    for (const DrillPath& path : paths) {
      // Through this level's own pedicle: past the middle of its isthmus by less than half of its width.
      const Json true_one = pedicle(n, path.name);
      const Vec3 from_mm = vec3_of(true_one["isthmus_mm"]) - path.entry_mm;
      const double off_mm = (from_mm - from_mm.dot(path.direction()) * path.direction()).norm();
      EXPECT_LT(off_mm, 0.5 * true_one["height_mm"].get<double>()) << name << ' ' << path.name;
      ASSERT_TRUE(path.screw);
      EXPECT_LT(path.screw->diameter_mm, true_one["width_mm"].get<double>()) << name << ' ' << path.name;
    }
    for (const Json& side : figures["levels"][n]["suggestions"]) EXPECT_EQ(side.value("grade", ""), "A") << name;
    EXPECT_THAT(text_of("plans/" + name + ".html"),
                AllOf(HasSubstr("<title>" + name + "<"), HasSubstr("Left pedicle"), HasSubstr("Right pedicle"),
                      HasSubstr("Slices of the CT, "), HasSubstr("--levels all "), HasSubstr(" --ct CT"),
                      Not(HasSubstr("spine/"))));
  }
  // Each is what `grade` says of it.
  const test::ProgramRun graded = run("grade spine.vdb plans/L3.json --level L3 -o graded --json graded.json");
  ASSERT_EQ(graded.exit_code, 0) << graded.errors;
  const Json grades = read_json(in("graded.json"));
  ASSERT_EQ(grades["paths"].size(), 2U);
  for (const Json& path : grades["paths"]) EXPECT_EQ(path["grade"], "A");
}

TEST_F(PlanLevels, WriteRodsOfHeadsInLineWhereTheSpinesPediclesAre) {
  ASSERT_EQ(planned_.exit_code, 0) << planned_.errors;
  const Json rods = read_json(in("plans/rods.json"))["rods"];
  ASSERT_EQ(rods.size(), 2U);
  EXPECT_EQ(rods[0]["side"], "left");
  EXPECT_EQ(rods[1]["side"], "right");
  for (const Json& rod : rods) {
    const std::string side = rod["side"];
    EXPECT_THAT(planned_.output, HasSubstr(side + " rod, furthest head off it"));
    const Json& heads = rod["heads"];
    ASSERT_EQ(heads.size(), kLevels.size());
    std::vector<Vec3> centres_mm, true_mm;
    for (std::size_t n = 0; n < heads.size(); ++n) {
      EXPECT_EQ(heads[n]["level"], kLevels[n]);
      // The head of the plan that stands beside it.
      const std::vector<DrillPath> paths = read_plan(in(std::string("plans/") + kLevels[n] + ".json"));
      const DrillPath& path = paths[side == "left" ? 0 : 1];
      ASSERT_EQ(path.name, side);
      ASSERT_TRUE(path.screw);
      const double behind_tip_mm = path.screw->length_mm + 0.5 * path.screw->head.length_mm;
      const Vec3 head_mm = path.target_mm - behind_tip_mm * path.direction();
      centres_mm.push_back(vec3_of(heads[n]["centre_mm"]));
      EXPECT_LT((centres_mm.back() - head_mm).norm(), 1e-3);
      EXPECT_GT(vec3_of(heads[n]["axis"]).dot(-path.direction()), 1.0 - 1e-6);
      // Where a screw along the true pedicle's axis would have it.
      const Json true_one = pedicle(n, side);
      const Vec3 isthmus_mm = vec3_of(true_one["isthmus_mm"]);
      const double behind_mm = (isthmus_mm - head_mm).dot(vec3_of(true_one["axis"]));
      true_mm.emplace_back(isthmus_mm - behind_mm * vec3_of(true_one["axis"]));
      // Ways turn by 16 degrees at most and cross the isthmus within 70 % of its height: both together, at the head.
      EXPECT_LT((head_mm - true_mm.back()).norm(),
                std::tan(16.0 * kDegree) * behind_mm + 0.35 * true_one["height_mm"].get<double>());
    }
    for (std::size_t n = 0; n + 1 < heads.size(); ++n) {
      EXPECT_NEAR(heads[n]["to_next_mm"].get<double>(), (centres_mm[n + 1] - centres_mm[n]).norm(), 1e-3);
      const double angle_deg = std::acos(vec3_of(heads[n]["axis"]).dot(vec3_of(heads[n + 1]["axis"]))) / kDegree;
      EXPECT_NEAR(heads[n]["to_next_deg"].get<double>(), angle_deg, 0.01);
      // As far apart as their pedicles' axes are there; ways of a few degrees each take some mm of it.
      EXPECT_NEAR(heads[n]["to_next_mm"].get<double>(), (true_mm[n + 1] - true_mm[n]).norm(), 5.0);
    }
    EXPECT_FALSE(heads.back().contains("to_next_mm"));
    // Choices in line: the middle head is off the line through its neighbours' by less than a rod's own width.
    const Vec3 line = (centres_mm[2] - centres_mm[0]).normalized();
    const Vec3 from_mm = centres_mm[1] - centres_mm[0];
    EXPECT_LT((from_mm - from_mm.dot(line) * line).norm(), 5.5);
    // A curve of second order meets three heads.
    EXPECT_LT(rod["max_offset_mm"].get<double>(), 1e-6);
    EXPECT_GT(rod["min_bend_radius_mm"].get<double>(), 50.0);
  }
}

TEST_F(PlanLevels, TakesSomeOfThemInTheSpinesOrder) {
  const test::ProgramRun two = run("plan spine.vdb --auto --levels L4,L3 -o two --title 'Case 7' --errors none");
  ASSERT_EQ(two.exit_code, 0) << two.errors;
  EXPECT_THAT(test::everything_in(in("two")),
              testing::ElementsAre("L3.html", "L3.json", "L4.html", "L4.json", "files.txt", "rods.json"));
  const Json rods = read_json(in("two/rods.json"))["rods"];
  EXPECT_EQ(rods[0]["heads"][0]["level"], "L3");
  EXPECT_TRUE(rods[0]["min_bend_radius_mm"].is_null());  // two heads: a straight rod
  EXPECT_THAT(text_of("two/L3.html"), AllOf(HasSubstr("<title>Case 7, L3<"), HasSubstr("bone keeps")));
}

TEST_F(PlanLevels, AnswerNoWithReportsWhereThereIsNoPathAndLeaveNoOldPlan) {
  ASSERT_EQ(planned_.exit_code, 0) << planned_.errors;
  std::filesystem::copy(in("plans"), in("none"));
  const test::ProgramRun again = run("plan spine.vdb --auto --levels L2,L3 --margin 4 -o none --errors none");
  EXPECT_EQ(again.exit_code, 2) << "what is there is not replaced unasked";
  EXPECT_TRUE(std::filesystem::exists(in("none/L2.json")));
  const test::ProgramRun none =
      run("plan spine.vdb --auto --levels L2,L3 --margin 4 -o none --errors none --force --json none.json");
  EXPECT_EQ(none.exit_code, 1) << none.errors;
  EXPECT_THAT(test::everything_in(in("none")), testing::ElementsAre("L2.html", "L3.html", "files.txt", "rods.json"));
  EXPECT_THAT(text_of("none/L2.html"), HasSubstr("no path"));
  EXPECT_EQ(read_json(in("none/rods.json"))["rods"].size(), 0U);
  EXPECT_EQ(read_json(in("none.json"))["levels"].size(), 2U);
}

TEST_F(PlanLevels, SayInOneLineWhatIsWrongAndLeaveNothing) {
  const auto rejected = [&](const std::string& arguments, const char* why) {
    const std::vector<std::string> before = test::everything_in(folder_->path());
    const test::ProgramRun failed = run("plan " + arguments + " -o other");
    EXPECT_EQ(failed.exit_code, 2) << arguments;
    EXPECT_THAT(failed.errors, HasSubstr(why)) << arguments;
    EXPECT_EQ(std::count(failed.errors.begin(), failed.errors.end(), '\n'), 1) << failed.errors;
    EXPECT_EQ(test::everything_in(folder_->path()), before) << arguments;
  };
  rejected("spine.vdb --auto --levels L2,T4", "no T4 in spine.vdb; there are: L2, L3, L4");
  rejected("spine.vdb --auto --levels L2,middle", "no middle");
  rejected("spine.vdb --auto --levels L2,L2", "given twice");
  rejected("spine.vdb --auto --levels L2 --level L3", "--level");
  rejected("spine.vdb --levels L2", "--auto");
  rejected("spine.vdb --auto --levels all --report page.html", "--report");
  rejected("spine.vdb --auto --level L2 --ct spine/ct", "--report or --levels");
  rejected("spine.vdb --auto --levels all --ct nowhere", "nowhere");
  rejected("missing.vdb --auto --levels all", "missing.vdb");
}

}  // namespace
}  // namespace spinaltap
