// spinaltap bench on coarse points and over the loopback: the figures' form and their agreement, not the times.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/base/staged_output.h"
#include "core/files/json_file.h"
#include "tests/cli/program.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

using test::run_program;
using testing::ElementsAre;
using testing::HasSubstr;

class Bench : public testing::Test {
 protected:
  test::TemporaryFolder folder_;
};

TEST_F(Bench, MeasuresEnginesOnEachMotion) {
  const test::ProgramRun run = run_program(
      "bench drill --engine reference,arc,ring --spacing 0.3 --motion on-path,tremor-off-path --diameter 3.0 --window "
      "5 "
      "--json bench.json "
      "--plot bench.html",
      folder_.path());
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  EXPECT_THAT(run.output, HasSubstr("seed 1"));
  EXPECT_THAT(run.output, HasSubstr("reference*"));
  const Json figures = read_json(folder_.path() / "bench.json");
  // For each motion: reference and arc once, ring with 1 and 2 threads.
  ASSERT_EQ(figures["runs"].size(), 8U);
  for (const Json& one : figures["runs"]) {
    EXPECT_EQ(one["points"].get<int>(), 126 * 271);
    EXPECT_GT(one["cycles_per_cpu_s"]["last_tenth"].get<double>(), 0.0);
    EXPECT_GT(one["ratio_to_reference"]["last_tenth"].get<double>(), 0.0);
    EXPECT_LE(one["cpu_us"]["p50"].get<double>(), one["cpu_us"]["max"].get<double>());
    EXPECT_GT(one["bytes_per_point"].get<double>(), 1.0);
    const bool is_whole = one["engine"] == "ring";
    EXPECT_EQ(one["timed_cycles"].get<int>(), is_whole ? 37'800 : 55);
    EXPECT_EQ(one["curve_begin_end_cycles_per_cpu_s"].size(), is_whole ? 100U : 21U);
  }
  EXPECT_EQ(figures["runs"][2]["occupancy_hash"], figures["runs"][3]["occupancy_hash"]);
  EXPECT_NE(figures["runs"][2]["occupancy_hash"], figures["runs"][6]["occupancy_hash"]);
  EXPECT_THAT(read_whole_file(folder_.path() / "bench.html"), HasSubstr("Figure 20"));
}

TEST_F(Bench, MeasuresLongStepsWithEachNumberOfThreads) {
  const test::ProgramRun run = run_program(
      "bench drill --engine ring --spacing 0.3 --motion burr,sideways --threads 2,1 --json bench.json", folder_.path());
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  const Json figures = read_json(folder_.path() / "bench.json");
  ASSERT_EQ(figures["steps"].size(), 4U);
  EXPECT_EQ(figures["steps"][0]["threads"], 2);
  EXPECT_EQ(figures["steps"][0]["speed_up"], 1.0);
  EXPECT_EQ(figures["steps"][0]["removed"], figures["steps"][1]["removed"]);
  EXPECT_TRUE(figures["runs"].empty());
}

TEST_F(Bench, FindsTheSamePointsWithEveryEngine) {
  const test::ProgramRun run = run_program(
      "bench drill --spacing 0.3 --motion tremor,tilted,burr,sideways --diameter 3.06 --window 2", folder_.path());
  EXPECT_EQ(run.exit_code, 0) << run.errors;
}

TEST_F(Bench, MeasuresMillingsOfPointsAndVoxels) {
  const test::ProgramRun run = run_program(
      "bench drill --motion milling --spacing 0.5 --diameter 4 --engine leaf,voxel --json bench.json", folder_.path());
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  EXPECT_THAT(run.output, HasSubstr("voxel with forces"));
  EXPECT_THAT(run.output, HasSubstr("volumetric_drilling"));
  const Json figures = read_json(folder_.path() / "bench.json");
  // Points: upright, at 30 degrees, in short steps; voxels at 80 degrees, at each tilt with forces and turning, too.
  ASSERT_EQ(figures["millings"].size(), 3U + 8U);
  for (const Json& one : figures["millings"]) {
    EXPECT_EQ(one["cycles"], one["lever_mm"] > 0.0 ? 1'199 : 30'000);
    EXPECT_GT(one["cycles_per_cpu_s"].get<double>(), 0.0);
    EXPECT_LE(one["cpu_us"]["p99"].get<double>(), one["cpu_us"]["p99.9"].get<double>());
    EXPECT_GT(one["removed_mm3"].get<double>(), 10.0);
  }
  EXPECT_EQ(figures["peers"].size(), 4U);
}

TEST_F(Bench, SaysWhatAutoComesToBesideTheBest) {
  const test::ProgramRun run = run_program(
      "bench drill --motion on-path,tilted-60 --spacing 0.5 --diameter 3 --engine ring,leaf --threads 1 "
      "--json bench.json",
      folder_.path());
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  const Json choices = read_json(folder_.path() / "bench.json")["auto"];
  ASSERT_EQ(choices.size(), 2U);
  EXPECT_EQ(choices[0]["engine"], "ring");
  EXPECT_EQ(choices[1]["engine"], "leaf");
  for (const Json& choice : choices) {
    EXPECT_GE(choice["to_best"].get<double>(), 1.0);
    EXPECT_EQ(choice["to_best"] == 1.0, choice["engine"] == choice["best"]);
  }
}

TEST_F(Bench, RepeatsItsTremorBySeed) {
  const auto hash = [&](const std::string& seed) {
    const test::ProgramRun run = run_program(
        "bench drill --spacing 0.5 --motion tremor --diameter 3.0 --engine ring "
        "--threads 1 --json bench.json --force --seed " +
            seed,
        folder_.path());
    EXPECT_EQ(run.exit_code, 0) << run.errors;
    return read_json(folder_.path() / "bench.json")["runs"][0]["occupancy_hash"].get<std::string>();
  };
  const std::string first = hash("1");
  EXPECT_EQ(first, hash("1"));
  EXPECT_NE(first, hash("2"));
}

TEST_F(Bench, PrintsMarkdownWhereAskedFor) {
  const test::ProgramRun run = run_program(
      "bench drill --spacing 0.5 --motion tilted --diameter 3.06 --engine ring --threads 1 --markdown", folder_.path());
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  EXPECT_THAT(run.output, HasSubstr("|---|--:|---|"));
  EXPECT_THAT(run.output, HasSubstr("| tilted, 3.06 | 0.5 | ring | 1 |"));
}

TEST_F(Bench, LinkAnswersEveryPoseAndIsStopped) {
  const test::ProgramRun run =
      run_program("bench link --seconds 1 --rate 200 --stops 2 --garbage-rate 20 --json link.json", folder_.path());
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  EXPECT_THAT(run.output, HasSubstr("round trip"));
  const Json figures = read_json(folder_.path() / "link.json");
  EXPECT_EQ(figures["sent"], 200);
  // What came together with the next pose is merged, and has no answer of its own; so is what a busy machine kept back.
  EXPECT_GT(figures["returned"], 100);
  EXPECT_GE(figures["returned"].get<int>() + figures["merged"].get<int>(), 199);
  EXPECT_GT(figures["mesh_updates"], 0);
  EXPECT_EQ(figures["mesh_lost"], 0);
  EXPECT_GT(figures["nonsense_connections"], 1);  // it was turned away
  EXPECT_EQ(figures["stops"], 2);
  EXPECT_GT(figures["round_trip"]["p50_us"], 0.0);
  EXPECT_GE(figures["round_trip"]["max_us"], figures["round_trip"]["p50_us"]);
  EXPECT_EQ(run_program("bench link --rate nan", folder_.path()).exit_code, 2);
  EXPECT_EQ(run_program("bench link --seconds 0", folder_.path()).exit_code, 2);
}

TEST_F(Bench, IsRejectedInOneLineAndLeavesNoFile) {
  for (const char* arguments :
       {"--engine voxels", "--motion backwards", "--spacing 0", "--spacing 0.1,nan", "--diameter -3", "--diameter nan",
        "--threads 0", "--window 0", "--window 5000", "--hu-bits 12", "--seed -1 --engine"}) {
    const test::ProgramRun run = run_program(
        std::string("bench drill --engine ring --motion tilted --json bench.json ") + arguments, folder_.path());
    EXPECT_NE(run.exit_code, 0) << arguments;
    EXPECT_EQ(std::count(run.errors.begin(), run.errors.end(), '\n'), 1) << run.errors;
    EXPECT_THAT(test::everything_in(folder_.path()), ElementsAre());
  }
  EXPECT_EQ(run_program("bench drill --engine voxels", folder_.path()).exit_code, 2);
  EXPECT_EQ(run_program("bench", folder_.path()).exit_code, 2);
  // Files are rejected before the work: this would take minutes.
  const test::ProgramRun nowhere =
      run_program("bench drill --spacing 0.025 --json /proc/none/bench.json", folder_.path());
  EXPECT_EQ(nowhere.exit_code, 2);
  EXPECT_THAT(nowhere.errors, HasSubstr("/proc/none"));
}

}  // namespace
}  // namespace spinaltap
