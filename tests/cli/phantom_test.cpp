// From a phantom's CT to a bone, from the command line.

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/cli/program.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

TEST(PhantomFromTheShell, IsBakedFromASeedInItsBody) {
  const test::TemporaryFolder folder;
  const test::ProgramRun phantom = test::run_program(
      "phantom phantom --pixel 0.9 --size 112 --slices 38 --slice-step 1.4 --slice-width 1.4 --seed 5 "
      "--ground-truth-voxel 1",
      folder.path());
  ASSERT_EQ(phantom.exit_code, 0) << phantom.errors;
  const test::ProgramRun bake = test::run_program(
      "bake phantom/ct -o bone.vdb --voxel 0.7 --point-spacing 1 --seed-point 0,-10,0", folder.path());
  EXPECT_EQ(bake.exit_code, 0) << bake.errors;
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "bone.vdb"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "bone.vdb.cache"));
}

TEST(PhantomFromTheShell, MakesASpineWithALabelMapAndTheFiguresOfEachLevel) {
  const test::TemporaryFolder folder;
  const test::ProgramRun run = test::run_program(
      "phantom spine --spine T12-L1 --pixel 1.5 --size 80 --slice-step 3 --slice-width 3 --soft-tissue --metal L1",
      folder.path());
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  for (const char* file : {"ground_truth.json", "ground_truth_labels.nii.gz", "ct"}) {
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "spine" / file)) << file;
  }
  const test::ProgramRun wrong = test::run_program("phantom wrong --spine T12-Q1", folder.path());
  EXPECT_NE(wrong.exit_code, 0);
  EXPECT_NE(wrong.errors.find("found 'Q1'"), std::string::npos) << wrong.errors;
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "wrong"));
}

}  // namespace
}  // namespace spinaltap
