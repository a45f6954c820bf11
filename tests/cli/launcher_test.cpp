#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "core/base/version.h"
#include "tests/cli/program.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

namespace fs = std::filesystem;

/// Of what the dynamic linker reports at the start of a program.
long relocations(const std::string& statistics) {
  const std::string before = " number of relocations: ";
  const std::size_t at = statistics.find(before);
  return at == std::string::npos ? -1 : std::strtol(statistics.c_str() + at + before.size(), nullptr, 10);
}

TEST(Launcher, SaysTheVersionWithoutALibraryOfGrids) {
  const test::TemporaryFolder folder;
  const test::ProgramRun run = test::run_program("--version", folder.path(), "LD_DEBUG=statistics,libs");
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_EQ(run.output, std::string("spinaltap ") + version() + "\n");
  EXPECT_EQ(run.errors.find("libopenvdb"), std::string::npos);
  // OpenVDB's are 50,000, the C++ library's 5,000.
#ifndef SPINALTAP_ADDRESS_SANITIZER
  EXPECT_GT(relocations(run.errors), 0);
  EXPECT_LT(relocations(run.errors), 1'000);
#endif
  const test::ProgramRun help = test::run_program("--help", folder.path(), "LD_DEBUG=statistics,libs");
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_NE(help.errors.find("libopenvdb"), std::string::npos) << "the check above sees no library";
}

TEST(Launcher, SaysTheVersionThatTheCommandsDo) {
  const test::TemporaryFolder folder;
  const test::ProgramRun one = test::run_program("--version", folder.path());
  const test::ProgramRun other = test::run_program("--version --version", folder.path());
  EXPECT_EQ(one.output, other.output);
  EXPECT_EQ(one.exit_code, other.exit_code);
}

TEST(Launcher, IsFoundThroughALinkAndHandsOverArgumentsInputAndExitCode) {
  const test::TemporaryFolder folder;
  fs::create_symlink(SPINALTAP_PROGRAM, folder.path() / "s t");
  const test::ProgramRun unknown = test::run_command("'./s t' info 'no such' --json \"a'b\"", folder.path());
  EXPECT_EQ(unknown.exit_code, 2);
  const test::ProgramRun direct = test::run_program("info 'no such' --json \"a'b\"", folder.path());
  EXPECT_EQ(unknown.errors, direct.errors);
  EXPECT_NE(unknown.errors.find("no such"), std::string::npos) << unknown.errors;
  const test::ProgramRun help = test::run_command("'./s t' --help", folder.path());
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_NE(help.output.find("\n  phantom "), std::string::npos) << help.output;
}

TEST(Launcher, SaysWhichProgramItMisses) {
  const test::TemporaryFolder folder;
  fs::create_directory(folder.path() / "bin");
  fs::copy_file(SPINALTAP_PROGRAM, folder.path() / "bin/spinaltap");
  const test::ProgramRun run = test::run_command("bin/spinaltap --help", folder.path());
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_EQ(run.output, "");
  EXPECT_EQ(run.errors, "spinaltap: cannot run " + fs::canonical(folder.path()).string() +
                            "/bin/../libexec/spinaltap-commands: No such file or directory\n");
}

}  // namespace
}  // namespace spinaltap
