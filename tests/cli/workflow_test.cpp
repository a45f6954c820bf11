// The cohort's workflow: Snakemake takes it as it is. ./run cluster-test runs it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "core/files/data_files.h"
#include "tests/cli/program.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

using ::testing::HasSubstr;

/// Snakemake on the workflow's example, in a folder of its own.
test::ProgramRun snakemake(const std::string& options, const test::TemporaryFolder& folder) {
  const std::string workflow = data_file("workflows/cohort/Snakefile").parent_path();
  return test::run_command("export XDG_CACHE_HOME=$PWD/cache HOME=$PWD; snakemake --snakefile '" + workflow +
                               "/Snakefile' --configfile '" + workflow + "/example.yaml' --directory out " + options +
                               " 2>&1",
                           folder.path());
}

TEST(CohortWorkflow, IsWhatSnakemakeTakes) {
  const test::TemporaryFolder folder;
  if (test::run_command("command -v snakemake", folder.path()).exit_code != 0) GTEST_SKIP() << "no snakemake here";
  const test::ProgramRun dry = snakemake("--cores 2 --dry-run", folder);
  EXPECT_EQ(dry.exit_code, 0) << dry.output;
  // Five patients, and one study of them all in two shards.
  for (const char* count : {"segment ", "bake ", "plan "}) {
    const std::size_t line = dry.output.find(std::string("\n") + count);
    ASSERT_NE(line, std::string::npos) << count << dry.output;
    EXPECT_EQ(std::stoi(dry.output.substr(line + std::string(count).size())), 5) << count;
  }
  const std::size_t shards = dry.output.find("\nshard ");
  ASSERT_NE(shards, std::string::npos) << dry.output;
  EXPECT_EQ(std::stoi(dry.output.substr(shards + 6)), 2);
  // An image: the one thing that each cluster has another of, and that the check wants named.
  const test::ProgramRun lint = snakemake("--config container=docker://debian:12 --lint", folder);
  EXPECT_EQ(lint.exit_code, 0) << lint.output;
  EXPECT_THAT(lint.output, HasSubstr("good condition"));
}

TEST(CohortWorkflow, RejectsAPatientsNameThatYamlTakesForANumber) {
  const test::TemporaryFolder folder;
  if (test::run_command("command -v snakemake", folder.path()).exit_code != 0) GTEST_SKIP() << "no snakemake here";
  const std::string workflow = data_file("workflows/cohort/Snakefile").parent_path();
  for (const char* name : {"12", "0012", "yes"}) {
    const test::ProgramRun dry =
        test::run_command("export XDG_CACHE_HOME=$PWD/cache HOME=$PWD; sed 's/^  p1:/  " + std::string(name) + ":/' '" +
                              workflow + "/example.yaml' > own.yaml; snakemake --snakefile '" + workflow +
                              "/Snakefile' --configfile own.yaml --directory out --cores 2 --dry-run 2>&1",
                          folder.path());
    EXPECT_NE(dry.exit_code, 0) << name;
    EXPECT_THAT(dry.output, HasSubstr("put the name in quotes")) << name;
  }
  const test::ProgramRun quoted =
      test::run_command("export XDG_CACHE_HOME=$PWD/cache HOME=$PWD; sed 's/^  p1:/  \"0012\":/' '" + workflow +
                            "/example.yaml' > own.yaml; snakemake --snakefile '" + workflow +
                            "/Snakefile' --configfile own.yaml --directory out --cores 2 --dry-run 2>&1",
                        folder.path());
  EXPECT_EQ(quoted.exit_code, 0) << quoted.output;
  EXPECT_THAT(quoted.output, HasSubstr("0012"));
}

}  // namespace
}  // namespace spinaltap
