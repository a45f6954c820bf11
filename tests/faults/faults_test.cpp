// Each command on a disk that fills at each write, that rejects syncs and renames, killed at any of these moments, and
// with little memory: a word and exit code 2, no half file, the files of before, and a next run that ends right.
//
// A line of a table comes on standard output for each fault: command, fault, its moments, those tried, of these
// refused, done all the same, lost. SPINALTAP_FAULT_TRIALS=20 tries 20 moments of each fault, and of memory, instead of
// one.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "core/base/staged_output.h"
#include "core/files/json_file.h"
#include "tests/cli/program.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_kind.h"

namespace spinaltap {
namespace {

namespace fs = std::filesystem;

struct Task {
  std::string name;
  std::string arguments;  ///< all outputs are below out/
  /// Beginnings of names that a stopped run may leave, for the next to go on from.
  std::vector<std::string> goes_on = {};
  /// Names of files that the clock has a part in: whole, but never twice the same.
  std::vector<std::string> by_the_clock = {};
};

const std::array kTasks{
    Task{"phantom",
         "phantom out/cube --mesh cube.obj --units mm --axes LPS --pixel 0.6 --size 40 --slice-step 1.5 --slices 12"},
    Task{"segment", "segment l3/ct -o out/l3.seg.nrrd --picture out/l3.png --json out/segment.json"},
    Task{"points", "points l3/ct -o out/points.ply"},
    Task{"fit", "fit points.ply -o out/l3.rbf --reduce 0.4 --smoothing 0.1 --json out/fit.json"},
    Task{"eval_lattice", "eval l3.rbf --grid 3 -o out/field.nrrd"},
    Task{"eval_places", "eval l3.rbf points.ply -o out/values.csv --gradient"},
    Task{"bake", "bake l3/ct -o out/bone.vdb --voxel 0.6", {"bone.vdb.cache"}},
    Task{"mesh", "mesh bone.vdb -o out/bone.stl"},
    Task{"plan", "plan bone.vdb --auto --errors none -o out/plan.json --report out/plan.html"},
    Task{"grade", "grade bone.vdb l3/plan.json --errors none -o out/grade"},
    Task{
        "drill",
        "drill bone.vdb l3/plan.json --path left --feed 4 --spacing 0.4 --full-mesh -o out/drilled --record out/run.h5",
        {"run.h5"},
        {"drilled/log.csv", "drilled/report.html", "drilled/files.txt", "run.h5"}},
    Task{"export", "export run.h5 -o out/run.csv --events out/events.csv"},
    Task{"render", "render bone.vdb --size 200x150 -o out/bone.png"},
    Task{"study",
         "study study.json -o out/study",
         {"study"},
         {"study/breach_map.csv", "study/part-1-of-1.csv", "study/report.html", "study/summary.json"}},
};

Json study() {
  return {{"format", "spinaltap-study"},
          {"version", 2},
          {"bone", "bone.vdb"},
          {"plan", "l3/plan.json"},
          {"path", "left"},
          {"volume", {{"spacing_mm", 0.4}}},
          {"operator", {{"kind", "feed"}, {"feed_mm_s", 4.0}}},
          {"design", {{"runs", 3}, {"seed", 3}, {"factors", {{"density_scale", {{"levels", {0.6, 0.8, 1.0}}}}}}}}};
}

constexpr std::array kFaults{"write", "sync", "rename", "kill"};

using Files = std::map<std::string, std::string>;

Files files_in(const fs::path& folder) {
  Files found;
  if (!fs::exists(folder)) return found;
  for (const std::string& name : test::everything_in(folder)) {
    if (fs::is_regular_file(folder / name)) found[name] = read_whole_file(folder / name);
  }
  return found;
}

bool begins_as_one_of(const std::string& name, const std::vector<std::string>& beginnings) {
  return std::any_of(beginnings.begin(), beginnings.end(),
                     [&](const std::string& one) { return name.starts_with(one); });
}

bool is_hidden(const std::string& name) { return name.starts_with('.') || name.find("/.") != std::string::npos; }

int trials() {
  constexpr long kMax = 1000;
  const char* const text = std::getenv("SPINALTAP_FAULT_TRIALS");
  return text == nullptr ? 1 : static_cast<int>(std::clamp(std::strtol(text, nullptr, 10), 1L, kMax));
}

/// Up to `count` of 1 to `last`, evenly: the first and the last among them, or the middle one alone.
std::vector<long> moments(long last, int count) {
  if (last < 1) return {};
  if (count == 1) return {(last + 1) / 2};
  std::set<long> chosen;
  for (int n = 0; n < count; ++n) chosen.insert(1 + (last - 1) * n / (count - 1));
  return {chosen.begin(), chosen.end()};
}

class Faults : public ::testing::TestWithParam<Task> {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryFolder;
    for (const char* made :
         {"phantom l3 --pixel 0.8 --size 160 --slice-step 1.5 --slices 34", "points l3/ct -o points.ply",
          "fit points.ply -o l3.rbf --reduce 0.4 --smoothing 0.1", "bake l3/ct -o bone.vdb --voxel 0.6",
          "drill bone.vdb l3/plan.json --path left --feed 4 --spacing 0.4 -o drilled --record run.h5"}) {
      const test::ProgramRun run = test::run_program(made, folder_->path());
      ASSERT_EQ(run.exit_code, 0) << made << "\n" << run.errors;
    }
    write_whole_file(folder_->path() / "study.json", study().dump(2));
    write_whole_file(folder_->path() / "cube.obj",
                     "v 0 0 0\nv 8 0 0\nv 8 8 0\nv 0 8 0\nv 0 0 8\nv 8 0 8\nv 8 8 8\nv 0 8 8\n"
                     "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n");
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }

  static fs::path in(const std::string& name) { return folder_->path() / name; }

  static test::ProgramRun run(const Task& task, const std::string& before) {
    return test::run_command("timeout 300 " + before + " '" SPINALTAP_PROGRAM "' " + task.arguments + " --force",
                             folder_->path());
  }
  static std::string preloaded(const std::string& settings) {
    return "env LD_PRELOAD='" SPINALTAP_FAILING_OUTPUT "' SPINALTAP_FAULT_COUNTS='" + in("counts").string() + "' " +
           settings;
  }

  /// What the task writes when all goes well, which is then in clean/.
  static Files clean(const Task& task) {
    fs::remove_all(in("clean"));
    prepare(false);
    const test::ProgramRun done = run(task, "");
    EXPECT_EQ(done.exit_code, 0) << task.name << "\n" << done.errors;
    fs::rename(in("out"), in("clean"));
    return files_in(in("clean"));
  }

  /// out/ as it is before a trial: with the files of an earlier run, or empty.
  static void prepare(bool has_files) {
    fs::remove_all(in("out"));
    fs::create_directory(in("out"));
    if (has_files) fs::copy(in("clean"), in("out"), fs::copy_options::recursive);
  }

  /// How many moments of each of kFaults the last preloaded run came by.
  static std::array<long, 4> moments_passed() {
    std::istringstream counts(read_whole_file(in("counts")));
    std::array<long, 4> passed{};
    counts >> passed[0] >> passed[1] >> passed[2];
    passed[3] = passed[0] + passed[1] + passed[2];
    return passed;
  }

  /// What is wrong with files after a run that was not to end well; empty where nothing is.
  static std::string torn(const Task& task, const Files& expected, bool may_be_hidden) {
    std::string words;
    for (const auto& [name, content] : files_in(in("out"))) {
      if (begins_as_one_of(name, task.goes_on) || (may_be_hidden && is_hidden(name))) continue;
      const auto whole = expected.find(name);
      const bool is_clocked = begins_as_one_of(name, task.by_the_clock);
      if (whole == expected.end()) {
        words += "left " + name + "; ";
      } else if (is_clocked ? content.size() < whole->second.size() / 2 : content != whole->second) {
        words += "half of " + name + "; ";
      }
    }
    return words;
  }

  /// The next run, without a fault.
  static std::string next_run(const Task& task, const Files& expected) {
    const test::ProgramRun again = run(task, "");
    if (again.exit_code != 0) return "the next run ends with " + std::to_string(again.exit_code) + ": " + again.errors;
    std::string words = torn({task.name, task.arguments, {}, task.by_the_clock}, expected, false);
    const Files found = files_in(in("out"));
    for (const auto& [name, content] : expected) {
      if (!found.contains(name)) words += "the next run lacks " + name + "; ";
    }
    return words.empty() ? words : "after the next run: " + words;
  }

  static const test::TemporaryFolder* folder_;
};

const test::TemporaryFolder* Faults::folder_ = nullptr;

WHOLE_RUNS("Faults.*");

TEST_P(Faults, OfWritesSyncsRenamesAndKillsLoseNothing) {
  const Task& task = GetParam();
  const Files expected = clean(task);
  prepare(false);
  ASSERT_EQ(run(task, preloaded("")).exit_code, 0) << task.name;
  const std::array<long, 4> counted = moments_passed();
  EXPECT_GT(counted[0], 0) << task.name << ": expected writes of the program to be seen";
  int tries = 0;
  for (std::size_t kind = 0; kind < kFaults.size(); ++kind) {
    const char* const fault = kFaults[kind];
    const long last = counted[kind];
    int tried = 0, refused = 0, done = 0, lost = 0;
    const bool is_kill = std::string(fault) == "kill";
    for (const long moment : moments(last, trials())) {
      bool had_files = tries++ % 2 == 1;
      ++tried;
      const auto run_faulty = [&] {
        prepare(had_files);
        return run(task, preloaded("SPINALTAP_FAULT=" + std::string(fault) + ":" + std::to_string(moment)));
      };
      test::ProgramRun faulty = run_faulty();
      if (had_files && faulty.exit_code == 0 && moments_passed()[kind] < moment) {
        had_files = false;  // over files there was less left to do
        faulty = run_faulty();
      }
      std::string trouble;
      if (faulty.exit_code == 0) {
        ++done;
        // A rename has another way where the first is not to be had; how often a record is written is the clock's.
        if (std::string(fault) != "rename" && moments_passed()[kind] >= moment) trouble += "ended with 0; ";
      } else if (is_kill ? faulty.exit_code != 137 : faulty.exit_code != 2) {
        trouble += "ended with " + std::to_string(faulty.exit_code) + "; ";
      } else {
        ++refused;
      }
      if (!is_kill && faulty.exit_code != 0 && !faulty.errors.starts_with("spinaltap: ") &&
          faulty.errors.find("\nspinaltap: ") == std::string::npos) {
        trouble += "no word: \"" + faulty.errors + "\"; ";
      }
      trouble += torn(task, expected, is_kill);
      if (had_files && !is_kill) {
        const Files left = files_in(in("out"));
        for (const auto& [name, content] : expected) {
          if (!left.contains(name)) trouble += "the old " + name + " is gone; ";
        }
      }
      trouble += next_run(task, expected);
      if (trouble.empty()) continue;
      ++lost;
      ADD_FAILURE() << task.name << ", " << fault << " " << moment << " of " << last
                    << (had_files ? ", over files: " : ", anew: ") << trouble << "\n"
                    << faulty.errors;
    }
    std::printf("| %s | %s | %ld | %d | %d | %d | %d |\n", task.name.c_str(), fault, last, tried, refused, done, lost);
    std::fflush(stdout);
  }
}

TEST_P(Faults, OfMemoryAreToldAndLoseNothing) {
  // Below, the libraries of OpenVDB and TBB end the program before its work begins.
  constexpr long kLeastMb = 170, kMostMb = 600;
  const Task& task = GetParam();
  const Files expected = clean(task);
  for (const long moment : moments(kMostMb - kLeastMb, trials() + 2)) {
    const long megabytes = kLeastMb + moment;
    prepare(false);
    const test::ProgramRun small =
        test::run_command("ulimit -v " + std::to_string(megabytes * 1024) + "; timeout 300 '" + SPINALTAP_PROGRAM "' " +
                              task.arguments + " --force",
                          folder_->path());
    EXPECT_TRUE(small.exit_code == 0 || small.exit_code == 2)
        << task.name << " within " << megabytes << " MB ends with " << small.exit_code << "\n"
        << small.errors;
    EXPECT_TRUE(small.exit_code == 0 || !small.errors.empty()) << task.name << " within " << megabytes << " MB";
    EXPECT_EQ(torn(task, expected, false), "") << task.name << " within " << megabytes << " MB";
  }
}

TEST_P(Faults, OfTwoProcessesAtOnceLeaveOneWholeOutput) {
  const Task& task = GetParam();
  const Files expected = clean(task);
  prepare(false);
  const std::string one = "'" SPINALTAP_PROGRAM "' " + task.arguments + " --force";
  const test::ProgramRun both = test::run_command(
      one + " >/dev/null & first=$!; " + one + " >/dev/null; second=$?; wait $first; echo $? $second", folder_->path());
  std::istringstream codes(both.output);
  int first = -1, second = -1;
  codes >> first >> second;
  EXPECT_TRUE(first == 0 || second == 0) << task.name << ": " << both.output << both.errors;
  for (const int code : {first, second}) EXPECT_TRUE(code == 0 || code == 2) << task.name << ": " << both.errors;
  EXPECT_EQ(torn(task, expected, false), "") << task.name;
  EXPECT_EQ(next_run(task, expected), "") << task.name;
}

TEST_P(Faults, OfFileSystemsWithoutLocksChangeNothing) {
  const Task& task = GetParam();
  const Files expected = clean(task);
  prepare(false);
  const test::ProgramRun done = run(task, preloaded("SPINALTAP_FAULT=locks:0"));
  EXPECT_EQ(done.exit_code, 0) << task.name << done.errors;
  EXPECT_EQ(torn(task, expected, false), "") << task.name;
  const Files found = files_in(in("out"));
  // A study's rows are in one more file, of that process alone; the one that could not be locked stays empty.
  const std::string shared = "study/part-1-of-1.csv";
  EXPECT_EQ(found.size(), expected.size() + expected.count(shared)) << task.name;
  for (const auto& [name, content] : expected) {
    ASSERT_TRUE(found.contains(name)) << task.name << ": " << name;
    if (name == shared) EXPECT_EQ(found.at(name), "") << task.name;
  }
}

TEST_P(Faults, OfPlacesThatCannotBeWrittenAreToldFirst) {
  const Task& task = GetParam();
  fs::remove_all(in("out"));
  fs::create_directory_symlink("/proc/self", in("out"));
  const test::ProgramRun refused = run(task, "");
  EXPECT_EQ(refused.exit_code, 2) << task.name << refused.errors;
  EXPECT_NE(refused.errors.find("spinaltap: "), std::string::npos) << task.name << refused.errors;
  fs::remove(in("out"));
}

TEST_P(Faults, OfASymlinkedFolderWriteWhereItLeads) {
  const Task& task = GetParam();
  const Files expected = clean(task);
  fs::remove_all(in("out"));
  fs::remove_all(in("elsewhere"));
  fs::create_directory(in("elsewhere"));
  fs::create_directory_symlink("elsewhere", in("out"));
  EXPECT_EQ(run(task, "").exit_code, 0) << task.name;
  EXPECT_TRUE(fs::is_symlink(in("out"))) << task.name;
  const Files found = files_in(in("elsewhere"));
  EXPECT_EQ(found.size(), expected.size()) << task.name;
  for (const auto& [name, content] : expected) EXPECT_TRUE(found.contains(name)) << task.name << ": " << name;
  fs::remove(in("out"));
}

INSTANTIATE_TEST_SUITE_P(All, Faults, ::testing::ValuesIn(kTasks), [](const auto& one) { return one.param.name; });

}  // namespace
}  // namespace spinaltap
