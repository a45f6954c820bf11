// Heat from the command line: drill --heat, and heat of a record.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "core/base/staged_output.h"
#include "core/base/text_fields.h"
#include "core/files/data_files.h"
#include "core/files/json_file.h"
#include "core/files/plan_file.h"
#include "core/session/record/session_record.h"
#include "tests/cli/bone_ball.h"
#include "tests/cli/program.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

using test::kBoneCentre;
using test::kBoneRadiusMm;
using testing::HasSubstr;

/// A ball of 6 mm whose CT numbers are made cortex by a density calibration, drilled to a diameter's middle.
class Heat : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryFolder;
    test::write_bone_ball(folder_->path() / "bone.vdb");
    const Vec3 direction = Vec3(1.0, 2.0, -2.0) / 3.0;
    const Vec3 entry = kBoneCentre - kBoneRadiusMm * direction;
    write_plan({{"middle", entry, entry + 8.0 * direction, twist_drill(2.5, 30.0, 118.0, 0.4)}},
               folder_->path() / "plan.json");
    write_whole_file(folder_->path() / "cortex.json",
                     R"({"format": "spinaltap-density-calibration", "version": 2, "name": "cortex at 300 HU",
                         "density_at_0_hu_g_cm3": 0.0, "density_per_hu_g_cm3": 0.005, "sources": ["a test"]})");
    const test::ProgramRun drilled = run(kDrill + "--heat --heat-grid --record run.h5 --json drill.json");
    EXPECT_EQ(drilled.exit_code, 0) << drilled.errors;
    output_ = new std::string(drilled.output);
  }
  static void TearDownTestSuite() {
    delete output_;
    delete folder_;
  }

  static test::ProgramRun run(const std::string& arguments) {
    return test::run_program(arguments + " --force", folder_->path());
  }
  static Json json(const char* name) { return read_json(folder_->path() / name); }

  static inline const std::string kDrill =
      "drill bone.vdb plan.json --density cortex.json --radius 2 --spacing 0.2 --rate 200 --no-clearances --full-mesh "
      "--no-pictures -o out ";
  static const test::TemporaryFolder* folder_;
  static const std::string* output_;
};

const test::TemporaryFolder* Heat::folder_ = nullptr;
const std::string* Heat::output_ = nullptr;

TEST_F(Heat, IsToldOfADrillingInTextFiguresLogReportAndRecord) {
  EXPECT_THAT(*output_, HasSubstr("max temperature beside the hole"));
  EXPECT_THAT(*output_, HasSubstr("bone above 47 °C for 60 s"));
  const Json figures = json("drill.json");
  const double max_c = figures["max_temperature_c"].get<double>();
  EXPECT_GT(max_c, 40.0);
  EXPECT_GT(figures["heat"]["hottest_c"].get<double>(), max_c) << "at the wall";
  EXPECT_TRUE(std::filesystem::exists(folder_->path() / "out/heat.vdb"));
  EXPECT_THAT(read_whole_file(folder_->path() / "out/report.html"), HasSubstr("Hottest bone 0.50 mm from the wall"));
  // The log's largest is the record's, and both are the figures'.
  const SessionRecord record = read_record(folder_->path() / "run.h5");
  double recorded_c = 0.0;
  for (const RecordedCycle& cycle : record.cycles) recorded_c = std::max(recorded_c, cycle.temperature_c);
  EXPECT_NEAR(recorded_c, max_c, 1e-9);
  std::istringstream log(read_whole_file(folder_->path() / "out/log.csv"));
  std::string line;
  std::getline(log, line);
  EXPECT_THAT(line, HasSubstr(",max_temperature_c,cycles_per_s"));
  double logged_c = 0.0;
  while (std::getline(log, line)) {
    const std::size_t last = line.rfind(','), before = line.rfind(',', last - 1);
    logged_c = std::max(logged_c, parse_number(line.substr(before + 1, last - before - 1)).value_or(0.0));
  }
  EXPECT_NEAR(logged_c, max_c, 1e-4);
}

TEST_F(Heat, OfARecordIsThatOfTheDrilling) {
  const test::ProgramRun solved = run("heat run.h5 bone.vdb -o heat.vdb --volume heat.nrrd --json heat.json");
  ASSERT_EQ(solved.exit_code, 0) << solved.errors;
  EXPECT_THAT(solved.output, HasSubstr("hottest bone"));
  const Json heat = json("heat.json"), drilled = json("drill.json")["heat"];
  for (const auto& [key, value] : drilled.items()) EXPECT_EQ(heat[key], value) << key;
  EXPECT_EQ(read_whole_file(folder_->path() / "heat.vdb"), read_whole_file(folder_->path() / "out/heat.vdb"));
  EXPECT_THAT(read_whole_file(folder_->path() / "heat.nrrd"), testing::StartsWith("NRRD0004"));
  EXPECT_EQ(run("diff heat.vdb out/heat.vdb").exit_code, 0);
  // A record without heat is solved as well, with the shipped bone.
  ASSERT_EQ(run(kDrill + "--record plain.h5").exit_code, 0);
  EXPECT_FALSE(read_record(folder_->path() / "plain.h5").parts.has_heat);
  ASSERT_EQ(run("heat plain.h5 bone.vdb --json plain.json").exit_code, 0);
  EXPECT_EQ(json("plain.json")["hottest_c"], heat["hottest_c"]);
}

TEST_F(Heat, IsReplayedBitForBitWithEveryEngineAndThreadCount) {
  for (const std::string options : {"--engine ring --threads 1", "--engine leaf --threads 2", "--engine reference"}) {
    const test::ProgramRun replay = run("replay run.h5 bone.vdb " + options);
    EXPECT_EQ(replay.exit_code, 0) << options << "\n" << replay.output << replay.errors;
  }
}

TEST_F(Heat, FallsWithFeedWaterAndPecksThatWait) {
  const auto max_c = [](const std::string& options) {
    const test::ProgramRun drilled = run(kDrill + "--heat --json one.json " + options);
    EXPECT_EQ(drilled.exit_code, 0) << options << "\n" << drilled.errors;
    return json("one.json")["max_temperature_c"].get<double>();
  };
  const double usual_c = max_c("");
  EXPECT_GT(max_c("--feed 0.5"), usual_c);
  EXPECT_LT(max_c("--feed 2"), usual_c);
  EXPECT_LT(max_c("--irrigation"), usual_c);
  EXPECT_LT(max_c("--peck 0.5 --peck-pause 2"), usual_c);
}

TEST_F(Heat, TellsAnEventAboveItsLimitAndFailsOnHarmWhereAsked) {
  ASSERT_EQ(run(kDrill + "--heat --heat-limit 38 --json limit.json").exit_code, 0);
  const Json events = json("limit.json")["events"];
  const auto is_it = [](const Json& event) { return event["event"] == "heat limit"; };
  EXPECT_EQ(std::count_if(events.begin(), events.end(), is_it), 1);
  EXPECT_EQ(run("heat run.h5 bone.vdb --fail-on-harm").exit_code, 0) << "nothing stays hot for half a minute";
  // The same few degrees in bone that was nearly as hot before last longer than a minute.
  std::string file = read_whole_file(data_file("thermal/bone.json"));
  const std::string first = "\"temperature_c\": 37.0";
  ASSERT_NE(file.find(first), std::string::npos);
  file.replace(file.find(first), first.size(), "\"temperature_c\": 46.9");
  write_whole_file(folder_->path() / "hot.json", file);
  const test::ProgramRun harmed =
      run("heat run.h5 bone.vdb --fail-on-harm --thermal-bone hot.json -o hot.vdb --json hot_figures.json");
  EXPECT_EQ(harmed.exit_code, 1) << harmed.errors;
  EXPECT_GT(json("hot_figures.json")["above_47c_60s_mm3"].get<double>(), 0.0);
}

TEST_F(Heat, RejectsWhatMakesNoSense) {
  const auto rejected = [](const std::string& arguments, const std::string& why) {
    const test::ProgramRun failed = run(arguments);
    EXPECT_EQ(failed.exit_code, 2) << arguments;
    EXPECT_THAT(failed.errors, HasSubstr(why)) << arguments;
  };
  rejected(kDrill + "--irrigation", "expected --heat");
  rejected(kDrill + "--heat-grid", "expected --heat");
  rejected(kDrill + "--heat-limit 50", "expected --heat");
  rejected(kDrill + "--heat --heat-limit 30", "expected a limit above");
  rejected(kDrill + "--peck-pause 2", "expected --peck");
  rejected(kDrill + "--heat --additional-bone bone.vdb", "--additional-bone");
  rejected(kDrill + "--heat --thermal-bone plan.json", "plan.json");
  rejected("heat plan.json bone.vdb", "expected spinaltap heat RECORD BONE: plan.json is a plan");
  rejected("heat run.h5 bone.vdb --voxel 0", "--voxel");
  test::write_bone_ball(folder_->path() / "other.vdb", kBoneRadiusMm + 0.01);
  rejected("heat run.h5 other.vdb", "expected the bone that was drilled in run.h5");
  ASSERT_EQ(run("heat run.h5 bone.vdb -o there.vdb").exit_code, 0);
  const test::ProgramRun again = test::run_program("heat run.h5 bone.vdb -o there.vdb", folder_->path());
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_THAT(again.errors, HasSubstr("there already"));
}

}  // namespace
}  // namespace spinaltap
