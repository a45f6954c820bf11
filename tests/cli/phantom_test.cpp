// From a phantom's CT to a bone, from the command line.

#include <gtest/gtest.h>

#include <filesystem>

#include "tests/cli/program.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

TEST(PhantomFromTheShell, IsBakedFromASeedInItsBody) {
  const test::TemporaryFolder folder;
  const test::ProgramRun phantom = test::run_program(
      "phantom phantom --pixel 0.9 --size 112 --slices 38 --slice-step 1.4 --slice-width 1.4 --seed 5", folder.path());
  ASSERT_EQ(phantom.exit_code, 0) << phantom.errors;
  const test::ProgramRun bake =
      test::run_program("bake phantom/ct -o bone.vdb --voxel 0.7 --point-spacing 1 --seed 0,-10,0", folder.path());
  EXPECT_EQ(bake.exit_code, 0) << bake.errors;
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "bone.vdb"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "bone.vdb.cache"));
}

}  // namespace
}  // namespace spinaltap
