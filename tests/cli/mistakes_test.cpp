// Mistakes of who begins: what the program says tells what was meant. docs/mistakes.md.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "core/base/staged_output.h"
#include "core/files/plan_file.h"
#include "tests/cli/bone_ball.h"
#include "tests/cli/program.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_paths.h"

namespace spinaltap {
namespace {

namespace fs = std::filesystem;
using test::ProgramRun;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

class Mistakes : public ::testing::Test {
 protected:
  fs::path in(const std::string& name) const { return folder_.path() / name; }
  ProgramRun run(const std::string& arguments) const { return test::run_program(arguments, folder_.path()); }

  /// What a rejected call says: one line.
  std::string said(const std::string& arguments) const {
    const ProgramRun rejected = run(arguments);
    EXPECT_EQ(rejected.exit_code, 2) << arguments;
    EXPECT_EQ(rejected.output, "") << arguments;
    EXPECT_EQ(std::count(rejected.errors.begin(), rejected.errors.end(), '\n'), 1) << rejected.errors;
    EXPECT_THAT(rejected.errors, StartsWith("spinaltap: "));
    return rejected.errors;
  }

  test::TemporaryFolder folder_;
};

TEST_F(Mistakes, NamesTheCommandThatWasMeant) {
  EXPECT_THAT(said("bakke ct -o bone.vdb"), HasSubstr("no such command: bakke; did you mean bake?"));
  EXPECT_THAT(said("drlil"), HasSubstr("did you mean drill?"));
  EXPECT_THAT(said("seg ct"), HasSubstr("did you mean segment?"));
  EXPECT_THAT(said("submit study.json"), HasSubstr("did you mean study submit?"));
  EXPECT_THAT(said("bench dril"), HasSubstr("did you mean drill?"));
  EXPECT_THAT(said("helicopter"), AllOf(HasSubstr("no such command: helicopter"), Not(HasSubstr("did you mean"))));
  EXPECT_THAT(said(""), AllOf(HasSubstr("expected a command: demo, phantom"), HasSubstr("spinaltap --help")));
  EXPECT_THAT(said("help bakke"), HasSubstr("did you mean bake?"));
}

TEST_F(Mistakes, NamesTheOptionThatWasMeant) {
  EXPECT_THAT(said("bake ct --ouput bone.vdb"), AllOf(HasSubstr("bake has no option --ouput; did you mean --output?"),
                                                      HasSubstr("spinaltap bake --help")));
  EXPECT_THAT(said("bake ct --seed_point=1,2,3"), HasSubstr("did you mean --seed-point?"));
  EXPECT_THAT(said("bake ct -voxel 0.5"), HasSubstr("did you mean --voxel?"));
  EXPECT_THAT(said("drill bone.vdb plan.json --seed-point 1,2,3"),
              HasSubstr("has no option --seed-point: demo, segment, points and bake have it"));
  EXPECT_THAT(said("drill bone.vdb plan.json --colour red"), Not(HasSubstr("did you mean")));
}

TEST_F(Mistakes, NamesValuesAndArgumentsInsteadOfNumberingThem) {
  EXPECT_THAT(
      said("drill bone.vdb plan.json --engine rnig"),
      AllOf(HasSubstr("--engine: expected one of arc,auto,leaf,reference,ring,voxel, found rnig; did you mean ring?"),
            Not(HasSubstr("->"))));
  EXPECT_THAT(said("drill bone.vdb"), HasSubstr("plan is required: spinaltap drill BONE PLAN"));
  EXPECT_THAT(said("mesh bone.vdb bone.stl"), HasSubstr("did not expect bone.stl: spinaltap mesh BONE"));
}

TEST_F(Mistakes, NamesArgumentsThatAreSomethingElse) {
  test::write_bone_ball(in("bone.vdb"));
  const Vec3 below = test::kBoneCentre - test::kBoneRadiusMm * Vec3::UnitZ();
  write_plan({{"in", below, test::kBoneCentre, DrillBit{2.0, 30.0, 2.0}}}, in("plan.json"));
  for (const char* command : {"drill", "grade", "link"}) {
    EXPECT_THAT(said(std::string(command) + " plan.json bone.vdb"),
                HasSubstr(std::string("expected spinaltap ") + command +
                          " BONE PLAN: plan.json is a plan; bone.vdb is a bone (.vdb): swap them"));
  }
  fs::create_directory(in("folder"));
  fs::copy(in("bone.vdb"), in("folder"));
  EXPECT_THAT(said("mesh folder -o x.stl"), HasSubstr("folder is a folder; did you mean folder/bone.vdb?"));
  EXPECT_THAT(said("mesh plan.json -o x.stl"), AllOf(HasSubstr("plan.json is a plan"), Not(HasSubstr("swap"))));
  EXPECT_THAT(said("bake bone.vdb -o x.vdb"), HasSubstr("expected spinaltap bake CT: bone.vdb is a bone"));
  EXPECT_THAT(said("replay bone.vdb plan.json"), HasSubstr("expected spinaltap replay RECORD BONE"));
  EXPECT_THAT(said("study plan.json"), HasSubstr("plan.json is a plan"));
  write_whole_file(in("l3.ply"), "ply\nformat ascii 1.0\n");
  EXPECT_THAT(said("grade l3.ply plan.json"), HasSubstr("l3.ply is a mesh"));
  write_whole_file(in("study.json"), R"({"format": "spinaltap-study", "version": 2})");
  EXPECT_THAT(said("drill bone.vdb study.json"), HasSubstr("study.json is a study"));
  write_whole_file(in("bits.json"), R"({"format": "spinaltap-bits", "version": 2})");
  EXPECT_THAT(said("drill bone.vdb bits.json"), HasSubstr("bits.json is JSON of another format, spinaltap-bits"));
}

TEST_F(Mistakes, StoppedWorkSaysHowToGoOn) {
  // SIGTERM does what Ctrl-C does; it is sent when the program waits for it, as the kernel says (signal 15).
  const ProgramRun stopped = test::run_command(
      "'" SPINALTAP_PROGRAM
      "' phantom l3 & p=$!; "
      "until grep -q '^SigCgt:.*[4-7c-f][0-9a-f]\\{3\\}$' /proc/$p/status; do sleep 0.01; done; kill -TERM $p; wait $p",
      folder_.path());
  EXPECT_EQ(stopped.exit_code, 130);
  EXPECT_EQ(stopped.errors, "spinaltap: phantom stopped: nothing was written; the same command begins again\n");
  EXPECT_FALSE(fs::exists(in("l3")));
}

TEST(Help, IsACommandAndSoIsTheVersion) {
  const test::TemporaryFolder folder;
  const auto output = [&](const std::string& arguments) {
    const ProgramRun run = test::run_program(arguments, folder.path());
    EXPECT_EQ(run.exit_code, 0) << run.errors;
    return run.output;
  };
  for (const std::string command : {"", "bake", "study submit"}) {
    EXPECT_EQ(output("help " + command), output(command + " --help"));
  }
  EXPECT_EQ(output("version"), output("--version"));
}

/// The names in a help's list of subcommands.
std::vector<std::string> listed_commands(const std::string& help) {
  std::istringstream lines(help.substr(std::min(help.find("\nSubcommands:\n"), help.size())));
  std::vector<std::string> names;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("  ") && line[2] != ' ') names.push_back(line.substr(2, line.find(' ', 2) - 2));
  }
  return names;
}

TEST(Help, ListsNoCommandThatIsNotInThePagesTable) {
  const test::TemporaryFolder folder;
  const std::string page = read_whole_file(fs::path(test::kSourceFolder) / "docs/spinaltap.md");
  const std::string table = page.substr(page.find("| subcommand | what it does |"));
  const auto expect_row = [&](const std::string& command) {
    EXPECT_THAT(table.substr(0, table.find("\n\n")), HasSubstr("`" + command + "`"));
  };
  const std::vector<std::string> names = listed_commands(test::run_program("--help", folder.path()).output);
  EXPECT_GE(names.size(), 28U);
  for (const std::string& name : names) {
    if (name != "bench") expect_row(name);
  }
  for (const char* group : {"study", "bench"}) {
    for (const std::string& name :
         listed_commands(test::run_program(std::string(group) + " --help", folder.path()).output)) {
      expect_row(std::string(group) + " " + name);
    }
  }
}

}  // namespace
}  // namespace spinaltap
