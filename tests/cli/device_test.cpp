// drill --device: a hand at a device moves the bit.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>

#include "core/files/json_file.h"
#include "core/files/plan_file.h"
#include "core/session/record/session_record.h"
#include "tests/cli/bone_ball.h"
#include "tests/cli/program.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_paths.h"

namespace spinaltap {
namespace {

using test::kBoneCentre;
using test::kBoneRadiusMm;
using testing::HasSubstr;

class DrillByDevice : public ::testing::Test {
 protected:
  DrillByDevice() {
    test::write_bone_ball(folder_.path() / "bone.vdb");
    const Vec3 direction = Vec3(1.0, 2.0, -2.0) / 3.0;
    write_plan({{"middle", kBoneCentre - kBoneRadiusMm * direction, kBoneCentre, DrillBit{2.0, 30.0, 2.0}}},
               folder_.path() / "plan.json");
  }
  test::ProgramRun drill(const std::string& options) const {
    return test::run_program(
        "drill bone.vdb plan.json --spacing 0.2 --lead-in 1 -o out --force --json out.json --full-mesh --no-pictures " +
            options,
        folder_.path());
  }
  Json figures() const { return read_json(folder_.path() / "out.json"); }

  const test::TemporaryFolder folder_;
};

TEST_F(DrillByDevice, LoopbackIsRecordedAndReplaysBitForBit) {
  const test::ProgramRun run = drill("--device loopback:push=6,seconds=3,seed=7 --record run.h5");
  ASSERT_EQ(run.exit_code, 0) << run.output << run.errors;
  const Json out = figures();
  EXPECT_EQ(out["operator"]["kind"], "device");
  EXPECT_EQ(out["operator"]["device"], "loopback");
  EXPECT_EQ(out["operator_end"], "as planned");
  EXPECT_EQ(out["engine"], "voxel");
  EXPECT_NEAR(out["session_s"].get<double>(), 3.0, 0.002);  // when the hand ends it
  EXPECT_GT(out["removed"].get<int>(), 100);
  EXPECT_GT(out["max_depth_mm"].get<double>(), 1.0);
  EXPECT_LT(out["max_thrust_n"].get<double>(), 80.0);  // the device gives 8 N, a tenth of the bone's
  const SessionRecord record = read_record(folder_.path() / "run.h5");
  EXPECT_TRUE(record.parts.has_device);
  EXPECT_EQ(record.cycles.size(), out["cycles"].get<std::size_t>() + 1);  // with the first, where the bit is put
  const auto is_felt = [](const RecordedCycle& cycle) { return cycle.device.force_n.norm() > 0.1; };
  EXPECT_TRUE(std::any_of(record.cycles.begin(), record.cycles.end(), is_felt));
  const test::ProgramRun replay = test::run_program("replay run.h5 bone.vdb", folder_.path());
  EXPECT_EQ(replay.exit_code, 0) << replay.output << replay.errors;
}

TEST_F(DrillByDevice, APluginIsLoadedAndDrills) {
  const std::string plugin = test::kExamplePlugin;
  const test::ProgramRun run = drill("--device " + plugin + ":push --seconds 4 --record run.h5");
  EXPECT_EQ(run.exit_code, 1) << run.errors;  // this hand never ends it: the time does
  EXPECT_EQ(figures()["operator"]["device"], "pushed mass");
  EXPECT_EQ(figures()["operator_end"], "ran out of time");
  EXPECT_GT(figures()["removed"].get<int>(), 100);
  EXPECT_EQ(test::run_program("replay run.h5 bone.vdb", folder_.path()).exit_code, 0);
  const test::ProgramRun live = drill("--device " + plugin + " --real-time --seconds 2 --record live.h5");
  EXPECT_EQ(live.exit_code, 1) << live.errors;
  EXPECT_EQ(test::run_program("replay live.h5 bone.vdb", folder_.path()).exit_code, 0);
}

TEST_F(DrillByDevice, ALostDeviceCutsNothingAndEndsTheSession) {
  const test::ProgramRun run = drill("--device loopback:push=6,seconds=60,pulled=1.5 --record run.h5");
  EXPECT_EQ(run.exit_code, 1) << run.errors;
  EXPECT_EQ(figures()["operator_end"], "device lost");
  const SessionRecord record = read_record(folder_.path() / "run.h5");
  const auto lost = std::find_if(record.events.begin(), record.events.end(),
                                 [](const SessionEvent& event) { return event.kind == EventKind::device_lost; });
  ASSERT_NE(lost, record.events.end());
  EXPECT_NEAR(lost->time_s, 1.52, 0.003);
  for (const RecordedCycle& cycle : record.cycles) {
    if (cycle.time_s > lost->time_s + 0.001) {
      ASSERT_EQ(cycle.removed, 0U) << cycle.time_s;
    }
    if (cycle.time_s > lost->time_s + 0.051) {
      ASSERT_EQ(cycle.device.force_n.norm(), 0.0) << cycle.time_s;
    }
  }
}

TEST_F(DrillByDevice, WrongDevicesAndOptionsAreRejectedInWords) {
  const auto error = [&](const std::string& options) {
    const test::ProgramRun run = drill(options);
    EXPECT_EQ(run.exit_code, 2) << options;
    return run.errors;
  };
  EXPECT_THAT(error("--device none.so"), HasSubstr("expected a device's plug-in, found no such file: none.so"));
  EXPECT_THAT(error("--device plan.json"), HasSubstr("found no shared library that can be loaded in plan.json"));
  EXPECT_THAT(error(std::string("--device ") + test::kExamplePlugin + ":pull"),
              HasSubstr("expected the option push or none, found pull"));
  EXPECT_THAT(error("--device loopback:pull=3"), HasSubstr("expected push=, delay=, seconds=, pulled= or seed="));
  EXPECT_THAT(error("--device loopback:push=much"), HasSubstr("expected push= from 0 to 50, found \"much\""));
  EXPECT_THAT(error("--device loopback --operator push"), HasSubstr("expected no --operator with --device"));
  EXPECT_THAT(error("--device loopback --engine ring"), HasSubstr("expected no --engine ring with --device"));
  EXPECT_THAT(error("--device loopback --real-time"), HasSubstr("no clock of its own"));
  EXPECT_THAT(error("--force-scale 0.2"), HasSubstr("expected --device with --force-scale"));
  EXPECT_THAT(error("--device loopback --force-scale 0"), HasSubstr("expected"));
}

}  // namespace
}  // namespace spinaltap
