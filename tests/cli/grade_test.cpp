#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/files/json_file.h"
#include "core/files/plan_file.h"
#include "core/files/registration_file.h"
#include "core/phantom/vertebra_ground_truth.h"
#include "tests/cli/program.h"
#include "tests/support/temporary_folder.h"
#include "vdb/bake/bake.h"

namespace spinaltap {
namespace {

using ::testing::HasSubstr;

/// The phantom, with the paths along its pedicles' axes.
class Grade : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryFolder;
    const Vertebra vertebra;
    write_bone(bake_solid(vertebra, {}, 40.0), folder_->path() / "bone.vdb");
    const VertebraGroundTruth ground_truth = vertebra_ground_truth(vertebra);
    write_plan({{"left", ground_truth.left.entry_mm, ground_truth.left.target_mm, {}},
                {"right", ground_truth.right.entry_mm, ground_truth.right.target_mm, {}}},
               folder_->path() / "plan.json");
  }
  static void TearDownTestSuite() { delete folder_; }

  static const test::TemporaryFolder* folder_;
};

const test::TemporaryFolder* Grade::folder_ = nullptr;

TEST_F(Grade, WritesReportTableAndFiguresOfAllPaths) {
  const test::ProgramRun run = test::run_program(
      "grade bone.vdb plan.json --screw-diameter 6.5 --screw-length 45 -o out --json out.json", folder_->path());
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  const Json figures = read_json(folder_->path() / "out.json");
  ASSERT_EQ(figures["paths"].size(), 2U);
  for (const Json& path : figures["paths"]) {
    EXPECT_EQ(path["grade"], "A");
    EXPECT_EQ(path["pedicle"], path["name"]);
    // The isthmus is 9 mm wide.
    EXPECT_NEAR(path["outer"]["clearance_mm"].get<double>(), 1.25, 0.15);
    EXPECT_NEAR(path["canal"]["clearance_mm"].get<double>(), 1.25, 0.15);
    EXPECT_EQ(path["outer"]["side"], "lateral");
    EXPECT_EQ(path["canal"]["side"], "medial");
    EXPECT_GT(path["max_thrust_n"].get<double>(), 1.0);
    // Some 45 mm of screw in cancellous bone of a sound vertebra: hundreds to thousands of newtons.
    const Json& fixation = path["fixation"];
    EXPECT_GT(fixation["pullout_n"].get<double>(), 300.0);
    EXPECT_LT(fixation["pullout_n"].get<double>(), 5000.0);
    for (const std::string name : {"pullout_n", "stiffness_n_mm", "max_torque_n_mm"}) {
      EXPECT_LT(fixation["p05_" + name].get<double>(), fixation[name].get<double>()) << name;
      EXPECT_GT(fixation["p95_" + name].get<double>(), fixation[name].get<double>()) << name;
    }
    EXPECT_GT(fixation["engaged_mm"].get<double>(), 30.0);
    EXPECT_FALSE(fixation.contains("rows"));
    EXPECT_LT(path["p05_thrust_n"].get<double>(), path["p95_thrust_n"].get<double>());
    EXPECT_GT(path["p95_thrust_n"].get<double>(), path["max_thrust_n"].get<double>());
  }
  const Json whole_fixation = read_json(folder_->path() / "out" / "grade.json")["paths"][0]["fixation"];
  EXPECT_GT(whole_fixation["rows"].size(), 80U);
  EXPECT_THAT(run.output, HasSubstr("pull-out (5 to 95 %)"));
  EXPECT_THAT(run.output, HasSubstr("screw 6.5 x 45 mm"));
  EXPECT_GT(read_json(folder_->path() / "out" / "grade.json")["paths"][1]["rows"].size(), 100U);
  EXPECT_EQ(test::everything_in(folder_->path() / "out"),
            (std::vector<std::string>{"grade.csv", "grade.json", "report.html"}));
}

TEST_F(Grade, AddsTheErrorOfARegistrationToThatOfTheScrews) {
  // It slides by 1.5 mm to each side, and no more: as screws do whose entries err by that.
  Registration registration;
  registration.covariance.shift_mm2 = 1.5 * 1.5 * Mat3::Identity();
  registration.residuals_mm = {0.1, 0.2, 0.1};
  registration.warnings = {"fiducial 2 does not fit"};
  write_registration(registration, folder_->path() / "registration.json");
  const auto share_of_a = [&](const std::string& errors) {
    const test::ProgramRun run = test::run_program(
        "grade bone.vdb plan.json --path left --screw-diameter 6.5 --screw-length 45 --force -o registered --json "
        "registered.json --errors " +
            errors,
        folder_->path());
    EXPECT_EQ(run.exit_code, 0) << run.errors;
    EXPECT_EQ(run.output.find("registration.json: fiducial 2 does not fit") != std::string::npos,
              errors.find("registration.json") != std::string::npos);
    return read_json(folder_->path() / "registered.json")["paths"][0]["placement"];
  };
  const Json alone = share_of_a("none --registration registration.json"), screws = share_of_a("1.5,0");
  const Json both = share_of_a("1.5,0 --registration registration.json"), as_much = share_of_a("2.12132,0");
  EXPECT_NEAR(alone["grades"]["A"]["share"].get<double>(), screws["grades"]["A"]["share"].get<double>(), 0.03);
  EXPECT_NEAR(both["grades"]["A"]["share"].get<double>(), as_much["grades"]["A"]["share"].get<double>(), 0.03);
  EXPECT_LT(both["grades"]["A"]["share"].get<double>(), screws["grades"]["A"]["share"].get<double>() - 0.1);
  EXPECT_EQ(both["registration"]["file"], "registration.json");
  EXPECT_NEAR(both["registration"]["error_at_entry_mm"].get<double>(), 1.5 * std::sqrt(3.0), 1e-6);
  EXPECT_TRUE(screws["registration"].is_null());
}

TEST_F(Grade, TellsABreachThatWasAskedForByItsExitCode) {
  const auto exit_code_of = [&](const char* diameter_mm) {
    return test::run_program(
               std::string("grade bone.vdb plan.json --fail-on-breach --force -o asked --screw-length 45 ") +
                   "--screw-diameter " + diameter_mm,
               folder_->path())
        .exit_code;
  };
  // The isthmus is 9 mm wide.
  EXPECT_EQ(exit_code_of("6.5"), 0);
  EXPECT_EQ(exit_code_of("11"), 1);
}

TEST_F(Grade, RejectsOptionsWithoutSense) {
  for (const char* options : {"--path middle", "--screw-diameter 6.5", "--screw-diameter -1 --screw-length 45",
                              "--step 0", "--hu-bands 375,135", "--material none.json"}) {
    const test::ProgramRun run =
        test::run_program(std::string("grade bone.vdb plan.json -o rejected ") + options, folder_->path());
    EXPECT_NE(run.exit_code, 0) << options;
    EXPECT_FALSE(run.errors.empty()) << options;
    EXPECT_FALSE(std::filesystem::exists(folder_->path() / "rejected")) << options;
  }
}

}  // namespace
}  // namespace spinaltap
