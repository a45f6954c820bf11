// The example programs, which are what programs of others look like.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>

#include "tests/cli/program.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

using testing::HasSubstr;

/// A phantom, its baked bone and a plan.
class Examples : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryFolder;
    for (const char* command : {"phantom l3 --pixel 0.6 --size 300 --slices 50 --slice-step 1",
                                "bake l3/ct -o bone.vdb --voxel 0.6", "plan bone.vdb --auto -o plan.json"}) {
      const test::ProgramRun run = test::run_program(command, folder_->path());
      ASSERT_EQ(run.exit_code, 0) << command << ": " << run.errors;
    }
  }
  static void TearDownTestSuite() { delete folder_; }

  static test::ProgramRun example(const std::string& name, const std::string& arguments) {
    return test::run_command("'" SPINALTAP_EXAMPLES "/example_" + name + "' " + arguments, folder_->path());
  }

  static inline test::TemporaryFolder* folder_ = nullptr;
};

TEST_F(Examples, BakeAndDrillGivesForcesAtEachStepInFifteenLines) {
  const test::ProgramRun run = example("bake_and_drill", "l3/ct");
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  std::istringstream lines(run.output);
  std::size_t cycles = 0;
  double most_n = 0.0;
  for (std::string line; std::getline(lines, line); ++cycles) {
    double depth_mm = 0.0, thrust_n = 0.0, torque_n_mm = 0.0;
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf mm: %lf N, %lf N mm", &depth_mm, &thrust_n, &torque_n_mm), 3) << line;
    most_n = std::max(most_n, thrust_n);
  }
  EXPECT_GT(cycles, 20'000U);
  EXPECT_GT(most_n, 3.0) << "the cortex resists";
  EXPECT_LT(most_n, 300.0);

  std::ifstream source(SPINALTAP_EXAMPLE_SOURCES "/bake_and_drill.cpp");
  std::size_t lines_of_code = 0;
  for (std::string line; std::getline(source, line);) {
    if (!line.empty() && !line.starts_with("//")) ++lines_of_code;
  }
  EXPECT_GT(lines_of_code, 5U);
  EXPECT_LE(lines_of_code, 15U);
}

TEST_F(Examples, HapticLoopDrillsAgainstTheClock) {
  const test::ProgramRun run = example("haptic_loop", "bone.vdb plan.json");
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  EXPECT_THAT(run.output, HasSubstr("mm deep after 2.0 s"));
}

TEST_F(Examples, StudyCountsBreaches) {
  const test::ProgramRun run = example("study", "bone.vdb plan.json");
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  EXPECT_THAT(run.output, HasSubstr(" of 40 runs breach"));
}

TEST_F(Examples, SayWhatIsWrong) {
  const test::ProgramRun run = example("study", "none.vdb plan.json");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.errors, HasSubstr("none.vdb"));
}

}  // namespace
}  // namespace spinaltap
