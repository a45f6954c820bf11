// spinaltap link with a client in Python that knows nothing of it but OpenIGTLink's protocol.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "apps/link/linked_session.h"
#include "core/base/staged_output.h"
#include "core/files/json_file.h"
#include "core/files/plan_file.h"
#include "core/session/record/session_record.h"
#include "tests/cli/bone_ball.h"
#include "tests/cli/program.h"
#include "tests/support/recorded_hand.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_paths.h"
#include "vdb/sim/replay.h"

namespace spinaltap {
namespace {

using test::kBoneCentre;
using test::kBoneRadiusMm;
using testing::HasSubstr;

/// "x,y,z" in the frame outside.
std::string ras_text(const Vec3& lps) {
  return std::to_string(-lps.x()) + "," + std::to_string(-lps.y()) + "," + std::to_string(lps.z());
}

class Link : public ::testing::Test {
 protected:
  static constexpr double kDrilledMm = 8.0;

  static void SetUpTestSuite() {
    folder_ = new test::TemporaryFolder;
    test::write_bone_ball(folder_->path() / "bone.vdb");
    write_plan({{"left L4 of Jane Doe", entry(), entry() + 10.0 * direction(), DrillBit{2.0, 30.0, 2.0}}},
               folder_->path() / "plan.json");
  }
  static void TearDownTestSuite() { delete folder_; }

  static Vec3 direction() { return Vec3(1.0, 2.0, -2.0) / 3.0; }
  static Vec3 entry() { return kBoneCentre - kBoneRadiusMm * direction(); }

  /// Starts a link with `options`, runs the client, and waits for the link's end.
  static test::ProgramRun run_with_client(const std::string& options, const std::string& client_options,
                                          const std::string& in_between = "") {
    const std::string begin = ras_text(entry() - 2.0 * direction());
    const std::string end = ras_text(entry() + kDrilledMm * direction());
    return test::run_command(
        "rm -f out.txt; '" SPINALTAP_PROGRAM
        "' link bone.vdb plan.json --port 0 --seconds 60 --json link.json --force " +
            options +
            " > out.txt & pid=$!; for n in $(seq 600); do grep -q port out.txt && break; sleep 0.05; done;"
            " port=$(sed -n 's/.*port \\([0-9]*\\)$/\\1/p' out.txt); /usr/bin/python3 '" +
            test::kSourceFolder + "/tests/cli/link_client.py' $port --from=" + begin + " --to=" + end + " " +
            client_options + " > client.json; " + in_between + " wait $pid",
        folder_->path());
  }
  static Json json(const std::string& name) { return read_json(folder_->path() / name); }

  static const test::TemporaryFolder* folder_;
};

const test::TemporaryFolder* Link::folder_ = nullptr;

TEST_F(Link, DrillsWithAClientInPythonAndReplaysBitForBit) {
  const test::ProgramRun run = run_with_client("--record run.h5 --stop-at-thrust 3 --send-bone blocks", "--seconds 3");
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  const Json client = json("client.json"), link = json("link.json");
  EXPECT_EQ(client["bad_checksums"], 0);
  EXPECT_EQ(client["closed"], true);
  // A busy machine merges poses and comes late, which is counted; every cycle has its answer.
  EXPECT_EQ(client["returned"], link["cycles"]);
  EXPECT_GT(client["returned"].get<int>(), 300);
  EXPECT_LT(client["max_off_mm"].get<double>(), 1e-4);
  EXPECT_EQ(client["counts"]["POINT"], 1);
  EXPECT_GT(client["counts"]["STATUS"].get<int>(), 1);
  ASSERT_EQ(client["stops"].size(), 1U);
  EXPECT_EQ(client["stops"][0]["event"], "stop: thrust");
  EXPECT_GE(client["stops"][0]["value"].get<double>(), 3.0);
  EXPECT_EQ(client["last_state"]["stop"], true);
  EXPECT_NEAR(client["last_state"]["depth_mm"].get<double>(), kDrilledMm, 0.05);
  // The bone's surface is a ball in RAS.
  for (int axis = 0; axis < 3; ++axis) {
    const double centre = (axis < 2 ? -1.0 : 1.0) * kBoneCentre[axis];
    const Json& box_mm = client["box_ras_mm"][static_cast<std::size_t>(axis)];
    EXPECT_NEAR(box_mm[0].get<double>(), centre - kBoneRadiusMm, 0.05);
    EXPECT_NEAR(box_mm[1].get<double>(), centre + kBoneRadiusMm, 0.05);
  }
  const SessionRecord record = read_record(folder_->path() / "run.h5");
  EXPECT_TRUE(record.is_whole);
  EXPECT_EQ(record.cycles.size(), link["cycles"].get<std::size_t>());
  // The hand that the link recorded gives the same in a session of the same voxels and rule.
  std::vector<ToolInput> hand;
  for (const RecordedCycle& cycle : record.cycles) hand.push_back(input_of(cycle));
  SessionSetup setup;
  set_linked_defaults(setup);
  setup.options.stop.thrust_n = 3.0;
  const DrillPath path = read_plan(folder_->path() / "plan.json").front();
  EXPECT_EQ(hash_of(record), test::session_hash(Session(Bone::load(folder_->path() / "bone.vdb"), path, setup), hand));
  const test::ProgramRun replay = test::run_program("replay run.h5 bone.vdb", folder_->path());
  EXPECT_EQ(replay.exit_code, 0) << replay.output << replay.errors;
}

TEST_F(Link, HasAWholeRecordWhereTheClientVanishesAndTheProgramIsAskedToEnd) {
  const test::ProgramRun run =
      run_with_client("--record gone.h5 --send-bone whole", "--seconds 1 --rate 200 --no-end", "kill -INT $pid;");
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  const SessionRecord record = read_record(folder_->path() / "gone.h5");
  EXPECT_TRUE(record.is_whole);
  EXPECT_GT(record.cycles.size(), 50U);
  EXPECT_EQ(json("link.json")["ended_by_command"], false);
  EXPECT_EQ(test::run_program("replay gone.h5 bone.vdb", folder_->path()).exit_code, 0);
}

TEST_F(Link, RejectsOptionsThatMakeNoSense) {
  const auto rejected = [](const std::string& options) {
    const test::ProgramRun run = test::run_program("link bone.vdb plan.json " + options, folder_->path());
    EXPECT_EQ(run.exit_code, 2) << options;
    return run.errors;
  };
  EXPECT_THAT(rejected("--connect nowhere:0"), HasSubstr("HOST:PORT"));
  EXPECT_THAT(rejected("--no-server"), HasSubstr("--connect"));
  EXPECT_THAT(rejected("--tool-axis 0,0,0"), HasSubstr("direction"));
  EXPECT_THAT(rejected("--bind 300.0.0.1"), HasSubstr("address"));
  EXPECT_THAT(rejected("--no-clearances --stop-on-breach"), HasSubstr("clearances"));
  EXPECT_THAT(rejected("--tool-name abcdefghijklmnopqrst"), HasSubstr("19 letters"));
  EXPECT_THAT(rejected("--rate 0 --port 0"), HasSubstr("rate"));
}

}  // namespace
}  // namespace spinaltap
