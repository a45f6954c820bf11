#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/files/json_file.h"
#include "core/files/plan_file.h"
#include "core/phantom/vertebra_ground_truth.h"
#include "tests/cli/program.h"
#include "tests/support/analytic_bodies.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_kind.h"

namespace spinaltap {
namespace {

using ::testing::HasSubstr;

class PlanAuto : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryFolder;
    write_bone(bake_solid(Vertebra(), {.voxel_mm = 0.5}, 40.0), folder_->path() / "bone.vdb");
    write_bone(test::bake_ball({Vec3::Zero(), 12.0}, 0.5), folder_->path() / "ball.vdb");
  }
  static void TearDownTestSuite() { delete folder_; }

  static test::ProgramRun run(const std::string& arguments) {
    return test::run_program(arguments + " --force", folder_->path());
  }
  static std::filesystem::path in(const char* name) { return folder_->path() / name; }

  static const test::TemporaryFolder* folder_;
};

const test::TemporaryFolder* PlanAuto::folder_ = nullptr;

WHOLE_RUNS("PlanAuto.MakesACurvedPathThatIsGradedAndDrilledAlongItsCurve");

TEST_F(PlanAuto, WritesAPathWithAScrewForEachSideThatGradeCallsA) {
  const test::ProgramRun planned = run("plan bone.vdb --auto -o plan.json --report plan.html --json out.json");
  ASSERT_EQ(planned.exit_code, 0) << planned.errors;
  const std::vector<DrillPath> paths = read_plan(in("plan.json"));
  ASSERT_EQ(paths.size(), 2U);
  EXPECT_EQ(paths[0].name, "left");
  EXPECT_EQ(paths[1].name, "right");
  const Json figures = read_json(in("out.json"));
  EXPECT_NEAR(figures["landmarks"]["left_pedicle"]["width_mm"].get<double>(), 9.0, 0.1);
  for (std::size_t n = 0; n < 2; ++n) {
    ASSERT_TRUE(paths[n].screw);
    const Json& suggestion = figures["suggestions"][n];
    EXPECT_EQ(suggestion["screw"]["name"], paths[n].screw->name);
    EXPECT_GT(suggestion["safe_zone"]["medial_mm"].get<double>(), 0.9);
    EXPECT_NEAR(suggestion["convergence_deg"].get<double>(), 12.0, 8.0);
  }
  std::ostringstream html;
  html << std::ifstream(in("plan.html")).rdbuf();
  for (const char* part :
       {"Suggested paths", "Left pedicle", "A: no breach", "until it breaches", "<svg", "plan bone.vdb"}) {
    EXPECT_THAT(html.str(), HasSubstr(part));
  }

  const test::ProgramRun graded = run("grade bone.vdb plan.json -o graded --json graded.json");
  ASSERT_EQ(graded.exit_code, 0) << graded.errors;
  const Json grades = read_json(in("graded.json"));
  for (const Json& path : grades.at("paths")) {
    EXPECT_EQ(path["grade"], "A");
    EXPECT_EQ(path["pedicle"], path["name"]);
  }
}

TEST_F(PlanAuto, AnswersNoWithAReportWhereThereIsNoPath) {
  const test::ProgramRun planned =
      run("plan bone.vdb --auto --margin 4 --technique pedicle -o no_plan.json --report secret_report.html "
          "--json no_out.json --title Second");
  EXPECT_EQ(planned.exit_code, 1) << planned.errors;
  EXPECT_FALSE(std::filesystem::exists(in("no_plan.json")));
  EXPECT_EQ(read_json(in("no_out.json"))["suggestions"].size(), 2U);
  std::ostringstream html;
  html << std::ifstream(in("secret_report.html")).rdbuf();
  for (const char* part :
       {"<title>Second<", "no path", "4 mm of bone", "at its isthmus", ">9.0 mm<", "--margin 4 --technique pedicle"}) {
    EXPECT_THAT(html.str(), HasSubstr(part));
  }
  for (const std::string& name : {std::string("secret"), std::string("no_plan"), in("").string()}) {
    EXPECT_THAT(html.str(), ::testing::Not(HasSubstr(name))) << "names of files are nobody's business";
  }
}

TEST_F(PlanAuto, GoesToSlicerAndBack) {
  ASSERT_EQ(run("plan bone.vdb --auto -o plan.json").exit_code, 0);
  ASSERT_EQ(run("plan bone.vdb --auto -o plan.mrk.json").exit_code, 0);
  const std::vector<DrillPath> own = read_plan(in("plan.json"));
  const std::vector<DrillPath> slicer = read_plan(in("plan.mrk.json"));
  ASSERT_EQ(own.size(), slicer.size());
  for (std::size_t n = 0; n < own.size(); ++n) {
    EXPECT_EQ(own[n].entry_mm, slicer[n].entry_mm);
    EXPECT_EQ(own[n].target_mm, slicer[n].target_mm);
  }
  EXPECT_EQ(run("grade bone.vdb plan.mrk.json -o slicer").exit_code, 0);
}

TEST_F(PlanAuto, MakesACurvedPathThatIsGradedAndDrilledAlongItsCurve) {
  const PedicleGroundTruth pedicle = vertebra_ground_truth(Vertebra()).left;
  const auto words = [](const Vec3& p_mm) {
    std::ostringstream text;
    text.precision(17);
    text << p_mm.x() << ',' << p_mm.y() << ',' << p_mm.z();
    return text.str();
  };
  // Past the isthmus the way bends to the midline.
  const Vec3 way_mm = pedicle.target_mm - pedicle.entry_mm;
  const Vec3 near_mm = pedicle.entry_mm + 0.3 * way_mm, far_mm = pedicle.entry_mm + 0.65 * way_mm;
  const Vec3 end_mm = pedicle.target_mm - Vec3(3.0, 0.0, 0.0);
  const std::string given =
      "plan bone.vdb --entry " + words(pedicle.entry_mm) + " --target " + words(end_mm) + " --via ";
  const test::ProgramRun planned =
      run(given + words(near_mm) + " --via " + words(far_mm) + " -o curve.json --json out.json");
  ASSERT_EQ(planned.exit_code, 0) << planned.errors;
  const DrillPath path = read_plan(in("curve.json")).front();
  ASSERT_EQ(path.via_mm, (std::vector<Vec3>{near_mm, far_mm}));
  EXPECT_EQ(path.bit, steerable_head());
  EXPECT_EQ(read_json(in("out.json"))["paths"][0]["length_mm"], path.length_mm());
  EXPECT_GT(path.length_mm(), path.chord_mm());

  const test::ProgramRun graded = run("grade bone.vdb curve.json -o graded --json out.json");
  ASSERT_EQ(graded.exit_code, 0) << graded.errors;
  EXPECT_THAT(graded.output, HasSubstr("not judged for a curved path"));
  EXPECT_EQ(read_json(in("out.json"))["paths"][0]["via_mm"].size(), 2U);
  EXPECT_NEAR(read_json(in("graded") / "grade.json")["paths"][0]["rows"].back()["depth_mm"].get<double>(),
              path.length_mm(), 1e-6);
  for (const auto& [engine, more] : {std::pair("auto", ""), {"voxel", " --no-pictures"}}) {
    const test::ProgramRun drilled =
        run("drill bone.vdb curve.json --radius 2 --spacing 0.25 --feed 10 --rate 200 --engine " + std::string(engine) +
            " -o drilled --full-mesh --record run.h5 --json out.json" + more);
    ASSERT_EQ(drilled.exit_code, 0) << drilled.errors;
    EXPECT_NEAR(read_json(in("out.json"))["max_depth_mm"].get<double>(), path.length_mm(), 1e-6);
    EXPECT_EQ(run("replay run.h5 bone.vdb").exit_code, 0);
    std::ostringstream events;
    events << std::ifstream(in("drilled") / "events.csv").rdbuf();
    EXPECT_THAT(events.str(), HasSubstr("contact"));
    EXPECT_THAT(events.str(), ::testing::Not(HasSubstr("outside volume"))) << engine;
  }

  const auto rejected = [&](const std::string& arguments, const char* why) {
    const test::ProgramRun failed = run(arguments);
    EXPECT_NE(failed.exit_code, 0) << arguments;
    EXPECT_THAT(failed.errors, HasSubstr(why)) << arguments;
  };
  rejected(given + "1,2 -o none.json", "--via x,y,z");
  rejected(given + words(near_mm) + " --diameter 2.5 -o none.json", "short enough for its bends");
}

TEST_F(PlanAuto, IsTheSameAtAnyNumberOfThreads) {
  ASSERT_EQ(run("plan bone.vdb --auto --threads 1 -o one.json").exit_code, 0);
  ASSERT_EQ(run("plan bone.vdb --auto --threads 2 -o two.json").exit_code, 0);
  EXPECT_EQ(read_json(in("one.json")), read_json(in("two.json")));
}

TEST_F(PlanAuto, SaysInOneLineWhatIsWrongAndWritesNothing) {
  const auto rejected = [&](const std::string& arguments, const char* why) {
    const test::ProgramRun failed = run("plan " + arguments + " -o none.json");
    EXPECT_NE(failed.exit_code, 0) << arguments;
    EXPECT_THAT(failed.errors, HasSubstr(why)) << arguments;
    EXPECT_EQ(std::count(failed.errors.begin(), failed.errors.end(), '\n'), 1) << failed.errors;
    EXPECT_FALSE(std::filesystem::exists(in("none.json")));
  };
  rejected("ball.vdb --auto", "canal");
  rejected("bone.vdb", "--auto");
  rejected("bone.vdb --auto --entry 1,2,3 --target 4,5,6", "--auto");
  rejected("bone.vdb --auto --margin -1", "margin");
  rejected("bone.vdb --auto --screws missing.json", "missing.json");
  rejected("bone.vdb --margin 1 --entry 1,2,3 --target 4,5,6", "--auto");
  rejected("bone.vdb --auto --shape plate --width 10 --thickness 1", "paths through pedicles, found a plate");
}

TEST_F(PlanAuto, WritesAPathForAPlate) {
  const std::string ball = "plan ball.vdb --entry 0,-12,0 --target 0,0,0 -o cut.json ";
  const test::ProgramRun made =
      run(ball + "--shape plate --width 12 --thickness 0.8 --bit-length 30 --stroke 4 --width-along 3,0,4");
  ASSERT_EQ(made.exit_code, 0) << made.errors;
  DrillBit saw = plate_bit(12.0, 0.8, 30.0, 4.0);
  saw.width_along = Vec3(0.6, 0.0, 0.8);
  const DrillBit read = read_plan(in("cut.json")).front().bit;
  EXPECT_LT((read.width_along - saw.width_along).norm(), 1e-15);
  saw.width_along = read.width_along;
  EXPECT_EQ(read, saw);
  ASSERT_EQ(run(ball + "--shape plate --width 12 --thickness 0.8").exit_code, 0);
  EXPECT_EQ(read_plan(in("cut.json")).front().bit, plate_bit(12.0, 0.8, 50.0));

  const test::ProgramRun graded = run("grade ball.vdb cut.json -o graded_cut");
  EXPECT_NE(graded.exit_code, 0);
  std::filesystem::remove(in("cut.json"));
  const auto rejected = [&](const std::string& arguments, const char* why) {
    const test::ProgramRun failed = run(ball + arguments);
    EXPECT_NE(failed.exit_code, 0) << arguments;
    EXPECT_THAT(failed.errors, HasSubstr(why)) << arguments;
    EXPECT_FALSE(std::filesystem::exists(in("cut.json")));
  };
  rejected("--shape plate", "--width and --thickness");
  rejected("--shape plate --width 12", "--width and --thickness");
  rejected("--shape plate --width 12 --thickness 0.8 --diameter 3", "--diameter");
  rejected("--shape plate --width 12 --thickness 0.8 --tip-length 3", "--tip-length");
  rejected("--width 12 --thickness 0.8", "--shape plate");
  rejected("--shape round-burr --thickness 0.8", "--shape plate");
  rejected("--width-along 0,1,0", "--shape plate");
  rejected("--bit match-head --width 12", "--width");
  rejected("--shape plate --width 12 --thickness 13", "thickness");
  rejected("--shape plate --width 12 --thickness 1 --stroke 12", "stroke");
  rejected("--shape plate --width 12 --thickness 1 --width-along 0,0,0", "not zero");
  rejected("--shape plate --width 12 --thickness 1 --width-along 0,1,0", "another --width-along");
}

}  // namespace
}  // namespace spinaltap
