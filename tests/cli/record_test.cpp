// Records from the command line: drill --record, replay, export, info.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "core/base/staged_output.h"
#include "core/files/json_file.h"
#include "core/files/plan_file.h"
#include "core/session/record/session_record.h"
#include "tests/cli/bone_ball.h"
#include "tests/cli/program.h"
#include "tests/support/recorded_hand.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

using test::kBoneCentre;
using test::kBoneRadiusMm;
using testing::AllOf;
using testing::HasSubstr;

/// A ball of bone, drilled through and out at the far side, at the clock's pace or not.
class Record : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryFolder;
    test::write_bone_ball(folder_->path() / "bone.vdb");
    const Vec3 direction = Vec3(1.0, 2.0, -2.0) / 3.0;
    write_plan({{"through", kBoneCentre - kBoneRadiusMm * direction, kBoneCentre + (kBoneRadiusMm + 2.0) * direction,
                 DrillBit{2.0, 30.0, 2.0}}},
               folder_->path() / "plan.json");
    const test::ProgramRun run = drill("--record run.h5");
    EXPECT_EQ(run.exit_code, 0) << run.errors;
  }
  static void TearDownTestSuite() { delete folder_; }

  static test::ProgramRun drill(const std::string& options) {
    return test::run_program(
        "drill bone.vdb plan.json --radius 1.6 --spacing 0.1 --operator tremor --full-mesh --no-pictures -o out " +
            options,
        folder_->path());
  }
  static test::ProgramRun run(const std::string& arguments) {
    return test::run_program(arguments + " --force", folder_->path());
  }

  static const test::TemporaryFolder* folder_;
};

const test::TemporaryFolder* Record::folder_ = nullptr;

TEST_F(Record, ReplaysBitForBitWithEveryEngineOnOneThreadAndTwo) {
  const SessionRecord record = read_record(folder_->path() / "run.h5");
  ASSERT_TRUE(record.is_whole);
  ASSERT_GT(record.cycles.size(), 5000U);
  ASSERT_FALSE(record.events.empty());
  for (const std::string engine : {"ring", "leaf", "arc", "reference"}) {
    for (const std::string threads : {"1", "2"}) {
      const test::ProgramRun replay =
          run("replay run.h5 bone.vdb --json replay.json --engine " + engine + " --threads " + threads);
      ASSERT_EQ(replay.exit_code, 0) << engine << ", " << threads << "\n" << replay.output << replay.errors;
      const Json figures = read_json(folder_->path() / "replay.json");
      EXPECT_EQ(figures["same"], true);
      EXPECT_EQ(figures["cycles"], record.cycles.size());
      EXPECT_EQ(figures["events"], record.events.size());
    }
  }
}

TEST_F(Record, OfARecordedHandIsThatOfASession) {
  const DrillPath path = read_plan(folder_->path() / "plan.json").front();
  const std::vector<ToolInput> hand = test::recorded_hand(path, folder_->path() / "hand.csv");
  const test::ProgramRun run = test::run_program(
      "drill bone.vdb plan.json --operator hand.csv --no-pictures --record hand.h5 -o hand", folder_->path());
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  const SessionRecord record = read_record(folder_->path() / "hand.h5");
  EXPECT_EQ(record.cycles.size(), hand.size());
  EXPECT_GE(record.events.size(), 2U);
  EXPECT_EQ(hash_of(record), test::session_hash(Session(Bone::load(folder_->path() / "bone.vdb"), path), hand));
}

TEST_F(Record, RejectsAnotherBoneAndWhatIsNoRecord) {
  test::write_bone_ball(folder_->path() / "other.vdb", kBoneRadiusMm + 0.01);
  const test::ProgramRun other = run("replay run.h5 other.vdb");
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.errors, AllOf(HasSubstr("record run.h5"), HasSubstr("another patient's")));
  const test::ProgramRun none = run("replay plan.json bone.vdb");
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.errors, HasSubstr("expected spinaltap replay RECORD BONE: plan.json is a plan"));
  const std::string bytes = read_whole_file(folder_->path() / "run.h5");
  write_whole_file(folder_->path() / "half.h5", bytes.substr(0, bytes.size() / 2));
  EXPECT_EQ(run("replay half.h5 bone.vdb").exit_code, 2);
  EXPECT_EQ(run("export half.h5 -o half.csv").exit_code, 2);
  EXPECT_FALSE(std::filesystem::exists(folder_->path() / "half.csv"));
}

TEST_F(Record, IsNotWrittenOver) {
  const std::string before = read_whole_file(folder_->path() / "run.h5");
  const test::ProgramRun again = drill("--record run.h5");
  EXPECT_NE(again.exit_code, 0);
  EXPECT_THAT(again.errors, HasSubstr("run.h5"));
  EXPECT_EQ(read_whole_file(folder_->path() / "run.h5"), before);
}

TEST_F(Record, BecomesATableWithARowForEachCycle) {
  const test::ProgramRun exported = run("export run.h5 -o run.csv --events events.csv");
  ASSERT_EQ(exported.exit_code, 0) << exported.errors;
  const SessionRecord record = read_record(folder_->path() / "run.h5");
  const std::string csv = read_whole_file(folder_->path() / "run.csv");
  EXPECT_EQ(static_cast<std::size_t>(std::count(csv.begin(), csv.end(), '\n')), record.cycles.size() + 1);
  std::ostringstream expected;
  write_record_csv(record, expected);
  EXPECT_EQ(csv, expected.str());
  EXPECT_THAT(read_whole_file(folder_->path() / "events.csv"), HasSubstr("contact,"));
  EXPECT_NE(run("export run.h5").exit_code, 0);
}

TEST_F(Record, IsDescribedByInfo) {
  const test::ProgramRun info = run("info run.h5 --json info.json");
  ASSERT_EQ(info.exit_code, 0) << info.errors;
  EXPECT_THAT(info.output, HasSubstr("contact"));
  const Json figures = read_json(folder_->path() / "info.json");
  EXPECT_EQ(figures["is_whole"], true);
  EXPECT_EQ(figures["setup"].count("session"), 1U);
}

}  // namespace
}  // namespace spinaltap
