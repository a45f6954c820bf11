// The program's way to compare grids: exit codes as of diff and cmp, figures, one line for what it cannot read.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/base/staged_output.h"
#include "core/files/json_file.h"
#include "core/tool/drill_bit.h"
#include "tests/cli/program.h"
#include "tests/support/analytic_bodies.h"
#include "tests/support/cut_hole.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

using test::ProgramRun;
using test::run_program;
using testing::HasSubstr;

const test::Ball kBall{Vec3(3.0, -2.0, 10.0), 6.0};

class Diff : public testing::Test {
 protected:
  void SetUp() override {
    const BoneModel bone = test::bake_ball(kBall);
    write_bone(bone, in("a.vdb"));
    write_bone(bone, in("same.vdb"));
    const Vec3 down(0.0, 0.0, -1.0);
    const Pose start{kBall.centre_mm + Vec3(0.0, 0.0, 10.0), down};
    const Pose end{kBall.centre_mm, down};
    write_bone(test::without_hole(bone, DrillBit{}, start, end), in("drilled.vdb"));
    const Pose deeper{kBall.centre_mm + 1.0 * down, down};
    write_bone(test::without_hole(bone, DrillBit{}, start, deeper), in("deeper.vdb"));
  }
  std::filesystem::path in(const char* name) const { return folder_.path() / name; }
  ProgramRun diff(const std::string& arguments) const { return run_program("diff " + arguments, folder_.path()); }

 private:
  test::TemporaryFolder folder_;
};

TEST_F(Diff, ExitsWith0WhereGridsAreTheSame) {
  const ProgramRun run = diff("a.vdb same.vdb --json d.json");
  EXPECT_EQ(run.exit_code, 0) << run.errors;
  const Json figures = read_json(in("d.json"));
  EXPECT_TRUE(figures.at("same").get<bool>());
  ASSERT_EQ(figures.at("grids").size(), 2U);
  EXPECT_EQ(figures.at("grids")[0].at("name"), "hu");
  EXPECT_EQ(figures.at("grids")[1].at("name"), "sdf");
  EXPECT_EQ(figures.at("grids")[1].at("linf"), 0.0);
}

TEST_F(Diff, ExitsWith1WhereTheyDiffer) {
  const ProgramRun run = diff("a.vdb drilled.vdb --json d.json");
  EXPECT_EQ(run.exit_code, 1) << run.errors;
  EXPECT_THAT(run.output, HasSubstr("first that differs"));
  const Json figures = read_json(in("d.json"));
  EXPECT_FALSE(figures.at("same").get<bool>());
  const auto grid = [&](const char* name) {
    for (const Json& one : figures.at("grids")) {
      if (one.at("name") == name) return one;
    }
    return Json();
  };
  const Json sdf = grid("sdf");
  EXPECT_FALSE(sdf.at("same").get<bool>());
  EXPECT_GT(sdf.at("different").get<int>(), 100);
  // From inside the bone to the middle of the hole: both values are within a band of 0.75 mm.
  EXPECT_GT(sdf.at("linf").get<double>(), 0.75);
  EXPECT_LE(sdf.at("linf").get<double>(), 1.5);
  EXPECT_TRUE(grid("hu").at("same").get<bool>());
  // Only the drilled one has them.
  EXPECT_FALSE(grid("hole").at("same").get<bool>());
  EXPECT_FALSE(grid("before").at("same").get<bool>());
}

TEST_F(Diff, ForgivesWhatTheToleranceAllows) {
  EXPECT_EQ(diff("deeper.vdb drilled.vdb --tolerance 1.6").exit_code, 0);
  EXPECT_EQ(diff("deeper.vdb drilled.vdb --tolerance 0.1").exit_code, 1);
}

TEST_F(Diff, ExitsWith2AndOneLineWhereAFileIsNoGood) {
  std::ofstream(in("text.vdb")) << "no grids\n";
  const std::string whole = read_whole_file(in("a.vdb"));
  std::ofstream(in("cut.vdb"), std::ios::binary) << whole.substr(0, whole.size() / 2);
  for (const char* arguments : {"a.vdb none.vdb", "text.vdb a.vdb", "a.vdb cut.vdb", "a.vdb", "a.vdb . ",
                                "a.vdb same.vdb --tolerance -1", "a.vdb same.vdb --tolerance nan"}) {
    const ProgramRun run = diff(arguments);
    EXPECT_EQ(run.exit_code, 2) << arguments;
    EXPECT_EQ(std::count(run.errors.begin(), run.errors.end(), '\n'), 1) << run.errors;
    EXPECT_THAT(run.errors, testing::StartsWith("spinaltap: "));
    EXPECT_EQ(run.output, "") << arguments;
  }
}

}  // namespace
}  // namespace spinaltap
