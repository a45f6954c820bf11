// What commands leave on the disk: never another's file, never some of a set, never an older run's among a newer one's.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/base/staged_output.h"
#include "core/files/json_file.h"
#include "core/files/plan_file.h"
#include "mesh/mesh_io.h"
#include "mesh/mesh_quality.h"
#include "tests/cli/bone_ball.h"
#include "tests/cli/program.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_paths.h"

namespace spinaltap {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

class Outputs : public ::testing::Test {
 protected:
  Outputs() {
    test::write_bone_ball(in("bone.vdb"));
    const Vec3 direction = Vec3(1.0, -2.0, -2.0) / 3.0;
    write_plan({{"in", test::kBoneCentre - test::kBoneRadiusMm * direction, test::kBoneCentre + 1.0 * direction,
                 DrillBit{2.0, 30.0, 2.0}}},
               in("plan.json"));
  }
  fs::path in(const std::string& name) const { return folder_.path() / name; }
  test::ProgramRun run(const std::string& arguments) const { return test::run_program(arguments, folder_.path()); }
  test::ProgramRun drill(const std::string& arguments) const {
    return run("drill bone.vdb plan.json --radius 1.2 --spacing 0.2 --step 0.02 --no-clearances --no-pictures " +
               arguments);
  }

  test::TemporaryFolder folder_;
};

TEST_F(Outputs, ThatAreThereAreReplacedWithForceOnlyAndThisIsSaidBeforeTheWork) {
  fs::create_directory(in("full"));
  for (const char* name : {"mine", "mine.vdb", "mine.png", "mine.json", "mine.stl", "mine.csv", "full/report.html",
                           "full/runs.csv", "full/00001.png", "full/L3.vdb"}) {
    write_whole_file(in(name), "years of work");
  }
  // None of the inputs is there: what is said is said before they are read.
  for (const char* arguments : {"demo -o full",
                                "phantom full",
                                "info none --contact-sheet mine.png",
                                "segment none -o mine",
                                "segment none --picture mine.png",
                                "points none -o mine",
                                "fit none -o mine",
                                "eval none none -o mine.csv",
                                "bake none -o mine.vdb",
                                "bake none --all -o full",
                                "plan none --auto -o mine.json",
                                "plan none --auto --report mine",
                                "grade none none -o full",
                                "drill none none -o full",
                                "drill none none --record mine",
                                "export none -o mine.csv",
                                "export none --events mine.csv",
                                "merge none -o full",
                                "merge full",
                                "mesh none -o mine.stl",
                                "render none -o mine.png",
                                "render none --record none --frames full",
                                "compare -o mine.png",
                                "diff none none --json mine.json",
                                "replay none none --json mine.json",
                                "sound none -o mine",
                                "sound none --events mine.json",
                                "bench drill --json mine.json",
                                "bench drill --plot mine",
                                "study none --json mine.json"}) {
    SCOPED_TRACE(arguments);
    const test::ProgramRun rejected = run(arguments);
    EXPECT_EQ(rejected.exit_code, 2);
    EXPECT_THAT(rejected.errors, AllOf(HasSubstr("is there already"), HasSubstr("--force")));
  }
  for (const std::string& name : test::everything_in(in("full"))) {
    EXPECT_EQ(read_whole_file(in("full") / name), "years of work") << name;
  }
  EXPECT_EQ(run("mesh bone.vdb -o mine.stl --force").exit_code, 0);
  EXPECT_NE(read_whole_file(in("mine.stl")), "years of work");
}

TEST_F(Outputs, OfAnotherKindAreNotReplacedByAPhantomEvenWithForce) {
  fs::create_directory(in("full"));
  write_whole_file(in("full/thesis.txt"), "years of work");
  EXPECT_THAT(run("phantom full --force").errors, HasSubstr("holds other files"));
  EXPECT_EQ(read_whole_file(in("full/thesis.txt")), "years of work");
}

TEST_F(Outputs, OfAnEarlierDrillingDoNotStayAmongNewOnes) {
  ASSERT_EQ(drill("--points --splats --record run.h5 --full-mesh -o out").exit_code, 0);
  write_whole_file(in("out/notes.txt"), "mine");
  EXPECT_THAT(test::everything_in(in("out")),
              AllOf(Contains("points.vdb"), Contains("splats.ply"), Contains("around.ply")));
  EXPECT_EQ(drill("-o out").exit_code, 2);
  const test::ProgramRun again = drill("--record run.h5 --full-mesh -o out --force");
  ASSERT_EQ(again.exit_code, 0) << again.errors;
  EXPECT_THAT(test::everything_in(in("out")), ElementsAre("drilled.stl", "drilled.vdb", "events.csv", "files.txt",
                                                          "log.csv", "notes.txt", "report.html"));
  const std::string list = read_whole_file(in("out/files.txt"));
  EXPECT_TRUE(list.starts_with("spinaltap-files whole\n")) << list;
  EXPECT_THAT(list, AllOf(HasSubstr("report.html"), Not(HasSubstr("notes.txt"))));
}

TEST_F(Outputs, OfALongerFilmDoNotStayAtTheEndOfAShorterOne) {
  ASSERT_EQ(drill("--record run.h5 --full-mesh -o out").exit_code, 0);
  const auto film = [&](const std::string& more) {
    return run("render bone.vdb --record run.h5 --frames film --size 32x24 --fps 1 " + more);
  };
  ASSERT_EQ(film("--speed 1").exit_code, 0);
  const std::size_t longer = test::everything_in(in("film")).size();
  EXPECT_EQ(film("--speed 4").exit_code, 2);
  EXPECT_EQ(test::everything_in(in("film")).size(), longer);
  ASSERT_EQ(film("--speed 4 --force").exit_code, 0);
  EXPECT_LT(test::everything_in(in("film")).size(), longer / 2);
}

TEST_F(Outputs, OfDrillAreMeshesToShowUnlessFullOnesAreAskedFor) {
  ASSERT_EQ(drill("-o shown").exit_code, 0);
  ASSERT_EQ(drill("-o full --full-mesh").exit_code, 0);
  const MeshQuality shown = measure_mesh(read_mesh(in("shown/drilled.stl")));
  const MeshQuality full = measure_mesh(read_mesh(in("full/drilled.stl")));
  EXPECT_LT(3 * shown.triangles, full.triangles);
  EXPECT_GT(shown.smallest_angle_deg, 1.0);  // slivers of 0.2 degrees were what such meshes had
  EXPECT_TRUE(shown.closed());
  EXPECT_NEAR(shown.volume_mm3, full.volume_mm3, 0.02 * full.area_mm2);
}

TEST_F(Outputs, OfDrillSayHowLongEachStageTook) {
  const test::ProgramRun drilled = drill("-o shown --json figures.json");
  ASSERT_EQ(drilled.exit_code, 0) << drilled.errors;
  const Json times = read_json(in("figures.json"))["times"];
  std::vector<std::string> names;
  double wall_s = 0.0, processor_s = 0.0;
  for (const Json& stage : times["stages"]) {
    names.push_back(stage["stage"]);
    wall_s += stage["wall_s"].get<double>();
    processor_s += stage["processor_s"].get<double>();
  }
  EXPECT_THAT(names, ElementsAre("read", "drilled", "meshed and drawn", "written"));
  EXPECT_NEAR(times["total"]["wall_s"].get<double>(), wall_s, 1e-6);
  EXPECT_NEAR(times["total"]["processor_s"].get<double>(), processor_s, 1e-6);
  EXPECT_GT(processor_s, 0.0);
  EXPECT_GT(times["most_memory_bytes"].get<double>(), 2e7);  // the libraries alone take more
  EXPECT_LT(times["most_memory_bytes"].get<double>(), 2e9);
  EXPECT_THAT(drilled.output, HasSubstr("GB of memory at most): read "));
}

TEST_F(Outputs, OfMeshThatMissWhatWasAskedAreAnExitCode) {
  EXPECT_EQ(run("mesh bone.vdb -o good.stl").exit_code, 0);
  const test::ProgramRun missed = run("mesh bone.vdb -o fine.stl --max-error 0.00001");
  EXPECT_EQ(missed.exit_code, 1) << missed.errors;
  EXPECT_TRUE(fs::exists(in("fine.stl")));
}

TEST_F(Outputs, NeedAJsonFileThatCanBeWrittenBeforeTheWorkIsDone) {
  write_whole_file(in("file"), "");
  for (const char* json : {"file/figures.json", ".", "/proc/none/figures.json"}) {
    SCOPED_TRACE(json);
    const test::ProgramRun rejected = run("mesh bone.vdb -o bone.stl --force --json " + std::string(json));
    EXPECT_EQ(rejected.exit_code, 2);
    EXPECT_FALSE(fs::exists(in("bone.stl")));
  }
  EXPECT_EQ(run("mesh none.vdb --json new/figures.json").exit_code, 2);
  EXPECT_FALSE(fs::exists(in("new"))) << "nothing of it stays where the work fails";
}

TEST_F(Outputs, OfRunAreWhereItWasCalled) {
  // A tree like ours, whose tools do nothing and whose program says where it is.
  fs::create_directories(in("tree/build/bin"));
  fs::create_directories(in("tools"));
  fs::create_directories(in("caller"));
  fs::copy_file(fs::path(test::kSourceFolder) / "run", in("tree/run"));
  write_whole_file(in("tree/build/build.ninja"), "test_planner spinaltap_python");
  const auto tool = [&](const std::string& name, const std::string& text) {
    write_whole_file(in(name), "#!/bin/sh\n" + text + "\n");
    fs::permissions(in(name), fs::perms::owner_all);
  };
  tool("tools/cmake", "exit 0");
  tool("tools/dpkg-query", "printf installed");
  for (const char* program : {"spinaltap", "spinaltap-planner"}) {
    tool(std::string("tree/build/bin/") + program, "echo \"$PWD\" \"$@\"");
  }
  const std::string path = "PATH='" + in("tools").string() + "':$PATH ../tree/run ";
  EXPECT_EQ(test::run_command(path + "demo ct -o out", in("caller")).output,
            in("caller").string() + " demo ct -o out\n");
  EXPECT_EQ(test::run_command(path + "planner ct", in("caller")).output, in("caller").string() + " ct\n");
}

}  // namespace
}  // namespace spinaltap
