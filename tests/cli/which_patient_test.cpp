#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "core/base/staged_output.h"
#include "core/files/json_file.h"
#include "core/files/plan_file.h"
#include "core/files/registration_file.h"
#include "core/phantom/vertebra.h"
#include "core/phantom/vertebra_ground_truth.h"
#include "tests/cli/program.h"
#include "tests/support/temporary_folder.h"
#include "vdb/bake/bake.h"
#include "vdb/grid/bone_model.h"

namespace spinaltap {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kCt = "00000000000000a1";
constexpr Level kL3{22};
constexpr const char* kOtherCt = "00000000000000b2";
constexpr const char* kDrill =
    " --radius 2 --spacing 0.4 --step 0.05 --no-clearances --full-mesh --no-pictures -o out ";

/// One vertebra as the L3 and the L4 of a CT, in a coarser grid, and as the L3 of another CT.
class WhichPatient : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryFolder;
    const Vertebra vertebra;
    const auto write = [&](const char* name, double voxel_mm, const char* ct, const char* level) {
      write_bone(bake_solid(vertebra, {.voxel_mm = voxel_mm}, 40.0, {}, {{"source_hash", ct}, {"level", level}}),
                 in(name));
    };
    write("l3.vdb", 0.8, kCt, "L3");
    write("l3_coarse.vdb", 1.0, kCt, "L3");
    write("l4.vdb", 1.0, kCt, "L4");
    write("other.vdb", 1.0, kOtherCt, "L3");
    const VertebraGroundTruth truth = vertebra_ground_truth(vertebra);
    DrillPath path{"left", truth.left.entry_mm, truth.left.target_mm, {3.0, 80.0, 1.0, BitShape::drill, 0.5}};
    write_plan({path}, in("nameless.json"));
    path.bone = {kCt, kL3};
    write_plan({path}, in("plan.json"));
    path.bone = {};
    for (Vec3* end : {&path.entry_mm, &path.target_mm}) *end = Vec3(-end->x(), -end->y(), end->z());
    write_plan({path}, in("ras.json"));
    path = {"left", truth.left.target_mm, truth.left.entry_mm, path.bit};
    write_plan({path}, in("swapped.json"));
  }
  static void TearDownTestSuite() { delete folder_; }

  static fs::path in(const std::string& name) { return folder_->path() / name; }
  static test::ProgramRun run(const std::string& arguments) {
    return test::run_program(arguments + " --force", folder_->path());
  }
  static void expect_rejected(const std::string& arguments, const std::vector<std::string>& words) {
    const test::ProgramRun tried = run(arguments);
    EXPECT_EQ(tried.exit_code, 2) << arguments << "\n" << tried.output;
    for (const std::string& word : words) EXPECT_THAT(tried.errors, HasSubstr(word)) << arguments;
  }

  static test::TemporaryFolder* folder_;
};
test::TemporaryFolder* WhichPatient::folder_ = nullptr;

TEST_F(WhichPatient, APlanNamesTheCtAndTheLevelOfItsBone) {
  ASSERT_EQ(run("plan l3.vdb --auto -o auto.json").exit_code, 0);
  const Json plan = read_json(in("auto.json"));
  EXPECT_EQ(plan["version"], 4);
  for (const Json& path : plan["paths"]) {
    EXPECT_EQ(path["bone"]["ct"], kCt);
    EXPECT_EQ(path["bone"]["level"], "L3");
  }
  ASSERT_EQ(run("plan l3.vdb --auto -o auto.mrk.json").exit_code, 0);
  EXPECT_EQ(read_plan(in("auto.mrk.json")).front().bone, (BoneIdentity{kCt, kL3}));
}

TEST_F(WhichPatient, OtherPatientsAndLevelsAreRefusedByName) {
  for (const char* command : {"grade", "drill", "render"}) {
    const std::string plan = std::string(command) == "render" ? " --plan plan.json" : " plan.json";
    expect_rejected(std::string(command) + " other.vdb" + plan,
                    {kCt, kOtherCt, "L3 of", "another patient's", "--other-ct"});
    expect_rejected(std::string(command) + " l4.vdb" + plan, {"L3 of", "L4 of", "another vertebra", "--other-ct"});
  }
  expect_rejected("link other.vdb plan.json --port 0 --seconds 0.2", {kCt, kOtherCt, "--other-ct"});
}

TEST_F(WhichPatient, TheSameCtInOtherVoxelsIsTheSame) {
  const test::ProgramRun graded = run("grade l3_coarse.vdb plan.json --errors none -o out --json g.json");
  EXPECT_EQ(graded.exit_code, 0) << graded.errors << graded.output;
  EXPECT_THAT(graded.output, Not(HasSubstr("note")));
  const Json figures = read_json(in("g.json"));
  EXPECT_EQ(figures["bone"]["ct"], kCt);
  EXPECT_EQ(figures["bone"]["level"], "L3");
  EXPECT_TRUE(figures["plan_notes"].empty());
}

TEST_F(WhichPatient, AnotherCtCanBeTakenAndIsWrittenDown) {
  const test::ProgramRun graded = run("grade other.vdb plan.json --errors none --other-ct -o out --json g.json");
  ASSERT_EQ(graded.exit_code, 0) << graded.errors;
  EXPECT_THAT(graded.output, HasSubstr(kOtherCt));
  for (const fs::path& file : {in("g.json"), in("out/grade.json"), in("out/report.html")}) {
    EXPECT_THAT(read_whole_file(file), HasSubstr("taken all the same")) << file;
  }
  const test::ProgramRun drilled = run(std::string("drill other.vdb plan.json --other-ct --record r.h5") + kDrill);
  ASSERT_EQ(drilled.exit_code, 0) << drilled.errors << drilled.output;
  EXPECT_THAT(read_whole_file(in("out/report.html")), HasSubstr("taken all the same"));
  EXPECT_EQ(run("replay r.h5 other.vdb").exit_code, 0);
  expect_rejected("replay r.h5 l4.vdb", {"L3 of the CT", kOtherCt, "L4 of the CT", kCt});
}

TEST_F(WhichPatient, ARecordNamesItsBoneAndRunsOnAnotherOneOnlyWhereThatIsSaid) {
  ASSERT_EQ(run(std::string("drill l3.vdb nameless.json --record n.h5") + kDrill).exit_code, 0);
  expect_rejected("replay n.h5 other.vdb", {"L3 of the CT", kOtherCt, kCt});
  expect_rejected("replay n.h5 l3_coarse.vdb", {"baked otherwise"});  // the same vertebra, but not the same bits
  const test::ProgramRun other = run("replay n.h5 l3_coarse.vdb --other-ct");
  EXPECT_EQ(other.exit_code, 1) << other.errors;
  EXPECT_THAT(other.output, HasSubstr("another bone"));
}

TEST_F(WhichPatient, PlansWithoutANameAreTakenWithAWord) {
  for (const std::string& command : {std::string("grade l3.vdb nameless.json --errors none -o out"),
                                     std::string("drill l3.vdb nameless.json") + kDrill,
                                     std::string("render l3.vdb --plan nameless.json -o p.png")}) {
    const test::ProgramRun taken = run(command);
    EXPECT_EQ(taken.exit_code, 0) << command << taken.errors << taken.output;
    EXPECT_THAT(taken.output, HasSubstr("this plan does not name its CT")) << command;
  }
}

TEST_F(WhichPatient, RasPointsAndSwappedEndsAreNamedAndNotDrilled) {
  for (const auto& [plan, cause] : {std::pair("ras.json", "RAS: x and y negated"), {"swapped.json", "swapped"}}) {
    const test::ProgramRun graded = run(std::string("grade l3.vdb ") + plan + " --errors none -o out --json g.json");
    EXPECT_EQ(graded.exit_code, 1) << plan << graded.errors;
    EXPECT_THAT(graded.output, HasSubstr(cause));
    EXPECT_THAT(read_json(in("g.json"))["plan_warnings"].dump(), HasSubstr(cause));
    EXPECT_THAT(read_whole_file(in("out/report.html")), HasSubstr("fits if"));
    EXPECT_EQ(run(std::string("grade l3.vdb ") + plan + " --errors none --accept-warnings -o out").exit_code, 0);
    expect_rejected(std::string("drill l3.vdb ") + plan + kDrill, {cause, "--force-path"});
    const test::ProgramRun forced = run(std::string("drill l3.vdb ") + plan + " --force-path" + kDrill);
    EXPECT_EQ(forced.exit_code, 0) << plan << forced.errors;
    EXPECT_THAT(forced.output, HasSubstr(cause));
  }
}

TEST_F(WhichPatient, GivenPointsAreCheckedToo) {
  const DrillPath path = read_plan(in("swapped.json")).front();
  const auto numbers = [](const Vec3& p) {
    return std::to_string(p.x()) + "," + std::to_string(p.y()) + "," + std::to_string(p.z());
  };
  const std::string points = " --entry " + numbers(path.entry_mm) + " --target " + numbers(path.target_mm);
  const test::ProgramRun planned = run("plan l3.vdb -o given.json" + points);
  EXPECT_EQ(planned.exit_code, 1) << planned.errors;
  EXPECT_THAT(planned.output, HasSubstr("swapped"));
  EXPECT_EQ(read_plan(in("given.json")).front().bone.ct_hash, kCt);  // written all the same
  EXPECT_EQ(run("plan l3.vdb --accept-warnings -o given.json" + points).exit_code, 0);
}

TEST_F(WhichPatient, AFeedBeyondTheToolsRangeWarns) {
  const std::string drill = std::string("drill l3.vdb plan.json --rate 1000 --feed ");
  const std::string options = " --radius 2 --spacing 0.4 --no-clearances --full-mesh --no-pictures -o out ";
  const test::ProgramRun fast = run(drill + "120" + options + "--json f.json");
  EXPECT_EQ(fast.exit_code, 1) << fast.errors;
  EXPECT_THAT(fast.output, HasSubstr("mm/min"));
  EXPECT_THAT(read_json(in("f.json"))["plan_warnings"].dump(), HasSubstr("2 mm/s"));
  EXPECT_EQ(run(drill + "120 --accept-warnings" + options).exit_code, 0);
  EXPECT_EQ(run(drill + "10" + options).exit_code, 0);
  const test::ProgramRun slow = run(std::string("drill l3.vdb plan.json --spindle 20") + kDrill);
  EXPECT_EQ(slow.exit_code, 1) << slow.errors;
  EXPECT_THAT(slow.output, HasSubstr("1200 rpm"));
  EXPECT_EQ(run(std::string("drill l3.vdb plan.json --spindle 0") + kDrill).exit_code, 0);
}

TEST_F(WhichPatient, StudiesRefuseAnotherBoneAndSayWhatWasTaken) {
  const auto spec = [](const char* bone, double feed_mm_s) {
    const Json json{{"format", "spinaltap-study"},
                    {"version", 2},
                    {"bone", bone},
                    {"plan", "plan.json"},
                    {"volume", {{"spacing_mm", 0.4}}},
                    {"operator", {{"kind", "feed"}, {"feed_mm_s", feed_mm_s}, {"step_mm", 0.1}}},
                    {"design", {{"runs", 1}}}};
    std::ofstream(in("study.json")) << json.dump();
  };
  spec("other.vdb", 1.0);
  expect_rejected("study study.json -o s1", {kCt, kOtherCt});
  const test::ProgramRun taken = run("study study.json --other-ct -o s2");
  EXPECT_EQ(taken.exit_code, 0) << taken.errors << taken.output;
  EXPECT_THAT(taken.output, HasSubstr("taken all the same"));
  EXPECT_THAT(read_whole_file(in("s2/study.json")), HasSubstr("takes_other_ct"));
  spec("l3_coarse.vdb", 1000.0);
  const test::ProgramRun fast = run("study study.json -o s3");
  EXPECT_EQ(fast.exit_code, 1) << fast.errors;
  EXPECT_THAT(fast.output, HasSubstr("mm/min"));
  EXPECT_THAT(read_whole_file(in("s3/study.json")), HasSubstr(kCt));
  EXPECT_THAT(read_whole_file(in("s3/runs.csv")), Not(HasSubstr("inf")));
}

TEST_F(WhichPatient, ARegistrationIsOfOneBone) {
  Registration found;
  found.noise_mm = 0.3;
  found.covariance.shift_mm2 = 0.01 * Mat3::Identity();
  found.covariance.turn_rad2 = 1e-6 * Mat3::Identity();
  found.bone = {kCt, kL3};
  write_registration(found, in("r.json"));
  EXPECT_EQ(read_json(in("r.json"))["version"], 3);
  EXPECT_EQ(read_registration(in("r.json")).bone, found.bone);
  expect_rejected("grade other.vdb nameless.json --errors none --registration r.json -o out",
                  {"registration r.json", kCt, kOtherCt});
  expect_rejected("plan l4.vdb --auto --registration r.json -o p.json", {"registration r.json", "L3 of", "L4 of"});
  EXPECT_EQ(run("grade l3.vdb plan.json --errors none --registration r.json -o out").exit_code, 0);
  found.bone = {};
  write_registration(found, in("old.json"));
  EXPECT_EQ(read_json(in("old.json"))["version"], 2);
  const test::ProgramRun old = run("grade l3.vdb plan.json --errors none --registration old.json -o out");
  EXPECT_EQ(old.exit_code, 0) << old.errors;
  EXPECT_THAT(old.output, HasSubstr("registration old.json does not name its CT"));
}

}  // namespace
}  // namespace spinaltap
