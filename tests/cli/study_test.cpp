// study and merge: the same bytes whatever the threads, the shards and the kills; what comes out follows the anatomy.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>
#include <sstream>
#include <thread>

#include "core/base/random.h"
#include "core/base/staged_output.h"
#include "core/files/json_file.h"
#include "core/files/plan_file.h"
#include "core/phantom/vertebra_ground_truth.h"
#include "core/study/study_row.h"
#include "core/study/study_task.h"
#include "core/tool/bit_profile.h"
#include "core/uncertainty/placement_errors.h"
#include "tests/cli/program.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_kind.h"
#include "vdb/bake/bake.h"
#include "vdb/sim/bone.h"

namespace spinaltap {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using Clock = std::chrono::steady_clock;

constexpr double kBitMm = 3.2;
const std::array<const char*, 4> kResults{"runs.csv", "summary.json", "breach_map.csv", "report.html"};

/// A study of a whole pedicle path of the phantom, at 0.1 mm and in steps of 10 µm.
Json whole_path_study(std::size_t runs) {
  return {{"format", "spinaltap-study"},
          {"version", 2},
          {"bone", "bone.vdb"},
          {"plan", "plan.json"},
          {"path", "left"},
          {"volume", {{"spacing_mm", 0.1}}},
          {"operator", {{"kind", "feed"}, {"feed_mm_s", 1.0}, {"step_mm", 0.01}, {"tremor_mm", 0.05}}},
          {"design",
           {{"runs", runs},
            {"sampling", "latin-hypercube"},
            {"seed", 3},
            {"factors",
             {{"entry_left_mm", {{"normal", {{"mean", 0.0}, {"deviation", 1.5}}}}},
              {"angle_head_deg", {{"uniform", {{"low", -3.0}, {"high", 3.0}}}}},
              {"density_scale", {{"levels", {0.6, 1.0}}}}}}}}};
}

/// 40 by default; SPINALTAP_STUDY_RUNS=1000 takes minutes.
std::size_t runs_of_the_large_study() {
  const char* runs = std::getenv("SPINALTAP_STUDY_RUNS");
  return runs != nullptr ? std::max(2UL, std::strtoul(runs, nullptr, 10)) : 40;
}

/// The phantom, with the path along its left pedicle's axis.
class Study : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryFolder;
    const Vertebra vertebra;
    write_bone(bake_solid(vertebra, {.voxel_mm = 0.5}, 40.0), folder_->path() / "bone.vdb");
    const VertebraGroundTruth ground_truth = vertebra_ground_truth(vertebra);
    write_plan(
        {{"left", ground_truth.left.entry_mm, ground_truth.left.target_mm, {kBitMm, 80.0, 1.0, BitShape::drill, 0.5}}},
        folder_->path() / "plan.json");
  }
  static void TearDownTestSuite() { delete folder_; }

  static fs::path in(const std::string& name) { return folder_->path() / name; }
  static void write(const Json& spec, const std::string& name) { std::ofstream(in(name)) << spec.dump(2); }
  static test::ProgramRun run(const std::string& arguments, const std::string& before = "") {
    return test::run_program(arguments + " --force", folder_->path(), before);
  }
  static void expect_done(const std::string& arguments) {
    const test::ProgramRun done = run(arguments);
    EXPECT_EQ(done.exit_code, 0) << arguments << "\n" << done.errors;
  }
  static void expect_same(const std::string& one, const std::string& two) {
    for (const char* name : kResults) {
      EXPECT_EQ(read_whole_file(in(one) / name), read_whole_file(in(two) / name)) << name << " of " << two;
    }
  }
  static std::vector<StudyRow> rows_of(const std::string& folder) {
    std::istringstream text(read_whole_file(in(folder) / "runs.csv"));
    std::string line;
    std::getline(text, line);
    EXPECT_EQ(line, study_csv_head());
    std::vector<StudyRow> rows;
    while (std::getline(text, line)) rows.push_back(read_study_csv(line));
    return rows;
  }

  static const test::TemporaryFolder* folder_;
};

const test::TemporaryFolder* Study::folder_ = nullptr;

WHOLE_RUNS("Study.FollowsTheAnatomy", "Study.IsTheSameToTheByteWithOneThreadTwoThreadsAndShards",
           "Study.KilledAtAnyMomentGoesOnAndEndsTheSame");

TEST_F(Study, IsTheSameToTheByteWithOneThreadTwoThreadsAndShards) {
  const std::size_t runs = runs_of_the_large_study() / 2 * 2;
  write(whole_path_study(runs / 2), "study.json");
  for (const auto& [folder, threads] : {std::pair{"one", "1"}, {"two", "2"}}) {
    expect_done(std::string("study study.json -o ") + folder + " --threads " + threads + " --json work.json");
    const Json work = read_json(in("work.json"))["work"];
    std::printf("%s thread(s): %.2f runs a second by the clock, %.1f ms of processor time a run\n", threads,
                work["runs_per_s"].get<double>(), 1e3 * work["cpu_seconds_per_run"].get<double>());
    EXPECT_EQ(work["runs"], runs);
  }
  expect_same("one", "two");
  ASSERT_EQ(rows_of("one").size(), runs);
  for (const char* shard : {"1", "2", "3", "4"}) {
    expect_done(std::string("study study.json --shard ") + shard + "/4 -o shard" + shard);
    EXPECT_FALSE(fs::exists(in(std::string("shard") + shard) / "runs.csv"));
  }
  const test::ProgramRun missing = run("merge shard1 shard2 shard4 -o early");
  EXPECT_NE(missing.exit_code, 0);
  EXPECT_THAT(missing.errors, HasSubstr("run 20 is the first that is missing"));
  EXPECT_FALSE(fs::exists(in("early")));
  expect_done("merge shard1 shard2 shard3 shard4 -o merged");
  expect_same("one", "merged");
  // Shards of two kinds in one folder, one after the other: the last one finds all runs there.
  expect_done("study study.json --shard 2/3 -o mixed");
  expect_done("study study.json -o mixed");
  expect_same("one", "mixed");
  // All is done: nothing is drilled again, and the results come from the rows alone.
  fs::remove(in("mixed") / "report.html");
  expect_done("study study.json -o mixed --json again.json");
  EXPECT_EQ(read_json(in("again.json"))["left"], 0);
  expect_same("one", "mixed");
}

/// Starts the study and kills it after `lifetime`. Returns whether it was still running then.
bool study_and_kill(const fs::path& folder, Clock::duration lifetime) {
  const pid_t process = ::fork();
  if (process == 0) {
    if (::chdir(folder.c_str()) != 0 || std::freopen("/dev/null", "w", stdout) == nullptr) ::_exit(3);
    const std::string command = std::string("exec '") + SPINALTAP_PROGRAM + "' study killed.json -o killed";
    ::execl("/bin/sh", "sh", "-c", command.c_str(), static_cast<char*>(nullptr));
    ::_exit(4);
  }
  std::this_thread::sleep_for(lifetime);
  ::kill(process, SIGKILL);
  int status = 0;
  ::waitpid(process, &status, 0);
  return WIFSIGNALED(status);
}

TEST_F(Study, KilledAtAnyMomentGoesOnAndEndsTheSame) {
  write(whole_path_study(8), "killed.json");
  const Clock::time_point start = Clock::now();
  expect_done("study killed.json -o whole");
  const Clock::duration duration = Clock::now() - start;
  constexpr std::uint64_t kSeed = 11;
  constexpr int kKills = 6;
  int killed = 0, with_rows = 0;
  std::uintmax_t size = 0;
  for (int n = 0; n < kKills; ++n) {
    const double share = random_uniform(kSeed, static_cast<std::uint64_t>(n));
    killed += study_and_kill(folder_->path(), std::chrono::duration_cast<Clock::duration>(share * duration)) ? 1 : 0;
    const fs::path part = in("killed") / "part-1-of-1.csv";
    if (!fs::exists(part)) continue;
    EXPECT_GE(fs::file_size(part) + 400, size) << "a kill lost rows";  // but for one that was cut short
    size = fs::file_size(part);
    with_rows += size > 400 ? 1 : 0;
  }
  std::printf("seed %d: %d of %d runs killed at work, %d left rows\n", static_cast<int>(kSeed), killed, kKills,
              with_rows);
  EXPECT_GE(killed, 2);
  expect_done("study killed.json -o killed");
  expect_same("whole", "killed");
}

/// Least distance to the outer surface, mm, from places all over a bit whose tip is at the line's target, from where
/// the entry opening ends.
double nearest_to_outer_mm(const Bone& bone, const DrillPath& line) {
  constexpr int kAround = 48;
  const BitProfile bit(line.bit);
  const Vec3 across_mm = any_perpendicular(line.direction());
  double min_mm = std::numeric_limits<double>::infinity();
  for (double back_mm = 0.0; back_mm < line.length_mm() - entry_end_mm(bone.walls(), line); back_mm += 0.1) {
    const double radius_mm = std::max(0.0, bit.widest_mm(back_mm, back_mm));
    for (int n = 0; n < kAround; ++n) {
      const Eigen::AngleAxisd turn(2.0 * std::numbers::pi * n / kAround, line.direction());
      const Vec3 place = line.target_mm - back_mm * line.direction() + radius_mm * (turn * across_mm);
      min_mm = std::min(min_mm, bone.walls().outer(place).distance_mm);
    }
  }
  return min_mm;
}

TEST_F(Study, FollowsTheAnatomy) {
  Json spec = whole_path_study(1);
  spec["operator"] = {{"kind", "feed"}, {"feed_mm_s", 1.0}, {"step_mm", 0.05}};
  spec["volume"] = {{"spacing_mm", 0.2}};
  write_bone(bake_solid(Vertebra(), {}, 40.0), in("fine.vdb"));
  spec["bone"] = "fine.vdb";
  spec["design"]["factors"] = {{"entry_left_mm", {{"levels", {-4.5, -1.0, 0.0, 1.0}}}},
                               {"density_scale", {{"levels", {0.6, 1.0}}}}};
  write(spec, "anatomy.json");
  expect_done("study anatomy.json -o anatomy");
  const double half_width_mm = 0.5 * vertebra_ground_truth(Vertebra()).left.width_mm;
  const Bone bone(read_bone(in("fine.vdb")));
  const DrillPath planned = read_plan(in("plan.json")).front();
  std::map<double, double> thrust_n;
  for (const StudyRow& row : rows_of("anatomy")) {
    const double left_mm = row[StudyFactor::entry_left_mm];
    EXPECT_EQ(row[StudyColumn::contact], 1.0);
    EXPECT_EQ(row[StudyColumn::outside_volume_mm], 0.0);
    EXPECT_EQ(row[StudyColumn::events_lost], 0.0);
    // The canal lies to the right of the left pedicle, the outer surface to its left: at the isthmus a shift along the
    // width takes of the one what it gives to the other. 0.2 mm: the width's axis is not quite the patient's left.
    EXPECT_NEAR(row[StudyColumn::min_clearance_canal_mm], half_width_mm + left_mm - 0.5 * kBitMm, 0.2) << left_mm;
    if (left_mm > -2.0) {
      EXPECT_EQ(row[StudyColumn::breach], 0.0) << left_mm;
      EXPECT_EQ(row[StudyColumn::grade], 0.0) << left_mm;
      DrillPath line = planned;
      for (Vec3* end_mm : {&line.entry_mm, &line.target_mm}) *end_mm += left_mm * across(planned).left;
      EXPECT_NEAR(row[StudyColumn::min_clearance_outer_mm], nearest_to_outer_mm(bone, line), 0.1) << left_mm;
    } else {
      EXPECT_EQ(row[StudyColumn::breach], 1.0) << left_mm;
      EXPECT_NEAR(row[StudyColumn::breach_canal_mm], -left_mm + 0.5 * kBitMm - half_width_mm, 0.2) << left_mm;
      EXPECT_GE(row[StudyColumn::grade], 1.0) << left_mm;
    }
    if (left_mm == 0.0) thrust_n[row[StudyFactor::density_scale]] = row[StudyColumn::max_thrust_n];
    // The whole path is drilled, and the hole is the bit's.
    EXPECT_NEAR(row[StudyColumn::depth_mm], planned.length_mm(), 0.1);
    const double hole_mm3 = 0.25 * std::numbers::pi * kBitMm * kBitMm * planned.length_mm();
    // On the path a ring of points lies just on the bit's wall, and stands for half a spacing more.
    const double on_ring = left_mm == 0.0 ? 1.0 + 0.5 * 0.2 / (0.5 * kBitMm) : 1.0;
    EXPECT_LT(row[StudyColumn::removed_mm3], 1.03 * on_ring * on_ring * hole_mm3);
    if (left_mm > -2.0) {
      EXPECT_GT(row[StudyColumn::removed_mm3], 0.85 * hole_mm3);
    }
  }
  // Softer bone is drilled with less thrust.
  ASSERT_EQ(thrust_n.size(), 2U);
  EXPECT_LT(thrust_n[0.6], 0.8 * thrust_n[1.0]);
  EXPECT_GT(thrust_n[0.6], 0.1 * thrust_n[1.0]);
}

TEST_F(Study, ALongerReactionPlungesFurther) {
  // On through the body's front, 14 mm past the planned target.
  DrillPath through = read_plan(in("plan.json")).front();
  through.target_mm += 14.0 * through.direction();
  write_plan({through}, in("through.json"));
  std::array<double, 2> plunge_depth_mm{};
  for (std::size_t n = 0; n < 2; ++n) {
    Json spec = whole_path_study(1);
    spec["plan"] = "through.json";
    spec["volume"] = {{"spacing_mm", 0.2}, {"lead_out_mm", 10}};
    spec["stop"] = {{"on_breach", true}};
    spec["operator"] = {{"kind", "push"}, {"push_n", 60}, {"reaction_s", n == 0 ? 0.05 : 0.1}, {"noticed_share", 0}};
    spec["design"]["factors"] = {{"push_n", {{"levels", {60, 90}}}}};
    const std::string name = "reaction" + std::to_string(n);
    write(spec, name + ".json");
    expect_done("study " + name + ".json -o " + name);
    const std::vector<StudyRow> rows = rows_of(name);
    ASSERT_EQ(rows.size(), 2U);
    for (const StudyRow& row : rows) {
      EXPECT_GT(row[StudyColumn::breach_outer_mm], 0.0);
      EXPECT_GT(row[StudyColumn::stop_mm], 30.0);
      // From where it was to stop to where it stood.
      EXPECT_NEAR(row[StudyColumn::plunge_depth_mm], row[StudyColumn::depth_mm] - row[StudyColumn::stop_mm], 0.3);
    }
    // A harder push goes further in the same time.
    EXPECT_GE(rows[1][StudyColumn::plunge_depth_mm], rows[0][StudyColumn::plunge_depth_mm]);
    plunge_depth_mm[n] = rows[0][StudyColumn::plunge_depth_mm];
    std::printf("%.2f s: %.2f and %.2f mm\n", n == 0 ? 0.05 : 0.1, rows[0][StudyColumn::plunge_depth_mm],
                rows[1][StudyColumn::plunge_depth_mm]);
  }
  EXPECT_GT(plunge_depth_mm[1], plunge_depth_mm[0] + 0.1);
}

TEST_F(Study, TellsWhichOperatorsGaveUpAndHowHotTheBoneGot) {
  Json spec = whole_path_study(1);
  spec["volume"] = {{"spacing_mm", 0.2}};
  spec["operator"] = {{"kind", "push"}, {"push_n", 40}, {"max_push_n", 0.5}};
  spec["design"]["factors"] = {{"push_n", {{"levels", {0.5, 100}}}}};
  spec["heat"] = Json::object();
  write(spec, "dry.json");
  spec["heat"] = {{"irrigation", true}};
  write(spec, "wet.json");
  expect_done("study dry.json -o dry");
  expect_done("study wet.json -o wet");
  const double length_mm = read_plan(in("plan.json")).front().length_mm();
  const std::vector<StudyRow> dry = rows_of("dry");
  const std::vector<StudyRow> wet = rows_of("wet");
  ASSERT_EQ(dry.size(), 2U);
  ASSERT_EQ(wet.size(), 2U);
  // Half a newton does not drill a cortex: it is left at its begin.
  EXPECT_GT(dry[0][StudyColumn::gave_up_mm], 0.8 * length_mm);
  EXPECT_NEAR(dry[0][StudyColumn::gave_up_mm], length_mm - dry[0][StudyColumn::depth_mm], 0.1);
  EXPECT_TRUE(std::isnan(dry[1][StudyColumn::gave_up_mm]));
  EXPECT_NEAR(dry[1][StudyColumn::depth_mm], length_mm, 0.5);
  EXPECT_EQ(read_json(in("dry") / "summary.json")["gave_up"]["count"], 1);
  // A hole's bone is warmer than the body; water cools it.
  EXPECT_GT(dry[1][StudyColumn::max_temperature_c], 37.05);
  EXPECT_LT(dry[1][StudyColumn::max_temperature_c], 150.0);
  EXPECT_LT(wet[1][StudyColumn::max_temperature_c], dry[1][StudyColumn::max_temperature_c]);
  EXPECT_EQ(wet[1][StudyColumn::depth_mm], dry[1][StudyColumn::depth_mm]);
  std::printf("0.5 N: %.2f mm short; 100 N: %.2f °C, with water %.2f °C\n", dry[0][StudyColumn::gave_up_mm],
              dry[1][StudyColumn::max_temperature_c], wet[1][StudyColumn::max_temperature_c]);
  spec["heat"] = {{"distance_mm", -1}};
  write(spec, "bad.json");
  EXPECT_THAT(run("study bad.json -o none").errors, HasSubstr("heat"));
}

TEST_F(Study, RejectsWhatMakesNoSense) {
  write(whole_path_study(2), "small.json");
  for (const char* shard : {"0/4", "5/4", "1", "1/", "/2", "1/2x", "a/b", "-1/2", "1/1000000"}) {
    const test::ProgramRun rejected = run(std::string("study small.json -o none --shard ") + shard);
    EXPECT_NE(rejected.exit_code, 0) << shard;
    EXPECT_THAT(rejected.errors, HasSubstr("shard")) << shard;
  }
  Json other = whole_path_study(2);
  other["design"]["factors"]["bit_diameter_mm"] = {{"levels", {3.0, -1.0}}};
  write(other, "bad.json");
  EXPECT_THAT(run("study bad.json -o none").errors, HasSubstr("bit_diameter_mm"));
  other = whole_path_study(2);
  other["design"]["factors"]["entry_left_mm"]["normal"]["deviation"] = 40.0;
  write(other, "far.json");
  EXPECT_THAT(run("study far.json -o none").errors, HasSubstr("radius_mm"));
  EXPECT_FALSE(fs::exists(in("none")));
  expect_done("study small.json -o small --shard 1/2");
  other = whole_path_study(2);
  other["name"] = "small";
  other["spindle_rpm"] = 900;
  write(other, "other.json");
  EXPECT_THAT(run("study other.json -o small").errors, HasSubstr("\"session\""));
  expect_done("study other.json -o other --shard 2/2");
  EXPECT_THAT(run("merge small other -o none").errors, HasSubstr("one study"));
  EXPECT_THAT(run("merge .").errors, HasSubstr("study.json"));
  EXPECT_FALSE(fs::exists(in("none")));
}

TEST_F(Study, KeepsFinishedRunsWhenTheDiskIsFull) {
  Json spec = whole_path_study(10);
  spec["volume"]["spacing_mm"] = 0.2;
  spec["operator"]["step_mm"] = 0.05;
  write(spec, "full.json");
  expect_done("study full.json -o roomy");
  // A limit on the size of a file makes writes fail as a full disk does: after some rows, of about 300 bytes each.
  const test::ProgramRun full = run("study full.json -o tight", "ulimit -f 8;");
  EXPECT_NE(full.exit_code, 0);
  EXPECT_THAT(full.errors, HasSubstr("the disk may be full"));
  EXPECT_FALSE(fs::exists(in("tight") / "runs.csv"));
  expect_done("study full.json -o tight --json tight.json");
  EXPECT_LT(read_json(in("tight.json"))["left"], 20);
  EXPECT_GT(read_json(in("tight.json"))["left"], 0);
  expect_same("roomy", "tight");
}

/// A cohort of two bones, of the left pedicle each, with errors as they were measured.
Json made_cohort(const char* sampling, std::size_t runs) {
  return {
      {"format", "spinaltap-study"},
      {"version", 2},
      {"kind", "geometry"},
      {"bones", {{{"bone", "bone.vdb"}, {"plan", "screw.json"}}, {{"bone", "bone.vdb"}, {"plan", "screw.json"}}}},
      {"errors",
       {{"name", "measured"},
        {"sources", {"made up"}},
        {"measured", {{0, 0, 0, 0, 0}, {-2.5, 0, 0, 0, 0}, {2.5, 0.5, 1, 2, 0}, {0, 1, -2, -6, 5}, {0, 4, 12, 0, 0}}}}},
      {"design", {{"runs", runs}, {"sampling", sampling}, {"seed", 5}}}};
}

TEST_F(Study, OfGeometryGradesEachScrewAsGradeDoesOnItsOwnPath) {
  std::vector<DrillPath> paths = read_plan(in("plan.json"));
  paths[0].screw = PedicleScrew{"", 6.5, 45.0, 4.5};
  write_plan(paths, in("screw.json"));
  write(made_cohort("random", 12), "cohort.json");
  expect_done("study cohort.json -o cohort");
  const std::vector<StudyRow> rows = rows_of("cohort");
  ASSERT_EQ(rows.size(), 24U);
  const Bone bone = Bone::load(in("bone.vdb"));
  const ErrorFrame frame = error_frame(bone.landmarks(), paths[0]);
  std::set<double> met;
  for (const StudyRow& row : rows) {
    const PlacementError error{row[StudyColumn::error_medial_mm], row[StudyColumn::error_cranial_mm],
                               row[StudyColumn::error_along_mm], row[StudyColumn::error_medial_deg],
                               row[StudyColumn::error_cranial_deg]};
    const PathGrade known = grade(bone, erred_path(paths[0], frame, error));
    EXPECT_EQ(row[StudyColumn::screw_grade], static_cast<double>(known.grade));
    EXPECT_NEAR(row[StudyColumn::screw_breach_mm], known.breach_mm, 1e-9);
    if (known.breach_mm > 0.0) {
      EXPECT_EQ(row[StudyColumn::screw_breach_side], static_cast<double>(known.breach_side));
      if (known.breaches_canal) {
        EXPECT_NEAR(row[StudyColumn::screw_canal_mm], known.breach_mm, 1e-9);
      }
    }
    EXPECT_NEAR(row[StudyColumn::screw_anterior_mm], known.side_breach_mm[4], 1e-9);
    EXPECT_EQ(row[StudyColumn::patient], row.run() < 12 ? 1.0 : 2.0);
    EXPECT_EQ(row[StudyColumn::side], 0.0);
    EXPECT_TRUE(std::isnan(row[StudyColumn::max_thrust_n]));
    met.insert(error.medial_mm + error.cranial_mm);
  }
  EXPECT_EQ(met.size(), 5U) << "every row of the table was drawn";
  const Json summary = read_json(in("cohort/summary.json"));
  EXPECT_FALSE(summary.contains("breach"));
  EXPECT_EQ(summary["screws"][0]["patients"], 2);
  EXPECT_EQ(summary["screws"][1]["of"], "patient 1");
}

TEST_F(Study, OfACohortIsTheSameToTheByteInShards) {
  std::vector<DrillPath> paths = read_plan(in("plan.json"));
  paths[0].screw = PedicleScrew{"", 6.5, 45.0, 4.5};
  write_plan(paths, in("screw.json"));
  write(made_cohort("saltelli", 20), "blame.json");
  expect_done("study blame.json -o blame --threads 2");
  for (const char* shard : {"1", "2", "3"}) {
    expect_done(std::string("study blame.json --threads 1 --shard ") + shard + "/3 -o blame" + shard);
  }
  expect_done("merge blame1 blame2 blame3 -o blame_merged");
  expect_same("blame", "blame_merged");

  // Two at once in one folder, while what it keeps of its bones is deleted again and again; then once more, damaged.
  const std::string shard_of_2 =
      std::string("'") + SPINALTAP_PROGRAM + "' study blame.json -o shared --threads 1 --shard ";
  const test::ProgramRun both =
      test::run_command(shard_of_2 + "1/2 & one=$!; " + shard_of_2 + "2/2 & two=$!; " +
                            "for n in 1 2 3 4 5 6 7 8; do rm -f shared/bone-*; sleep 0.2; done; wait $one && wait $two",
                        folder_->path());
  EXPECT_EQ(both.exit_code, 0) << both.errors;
  expect_done("merge shared");
  expect_same("blame", "shared");
  fs::remove(in("shared/part-2-of-2.csv"));
  expect_done("study blame.json -o shared --shard 1/2");
  std::size_t damaged = 0;
  for (const auto& kept : fs::directory_iterator(in("shared"))) {
    if (!kept.path().filename().string().starts_with("bone-")) continue;
    std::ofstream(kept.path()) << "{}";
    ++damaged;
  }
  EXPECT_EQ(damaged, 1U) << "both bones are one file, with one path";
  expect_done("study blame.json -o shared --shard 2/2");
  expect_same("blame", "shared");
  const Json summary = read_json(in("blame/summary.json"));
  ASSERT_TRUE(summary.contains("sensitivities"));
  EXPECT_TRUE(summary["sensitivities"][0]["inputs"].contains("entry"));
  EXPECT_TRUE(summary["sensitivities"][0]["inputs"].contains("screw"));
}

}  // namespace
}  // namespace spinaltap
