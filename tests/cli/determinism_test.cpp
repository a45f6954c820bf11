// The same input gives the same files: on one thread and two, with every instruction set, under another locale, in
// another folder. docs/determinism.md has the table, and says why some files are left out here.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <sstream>

#include "core/base/hash.h"
#include "core/base/instruction_set.h"
#include "core/base/staged_output.h"
#include "core/files/json_file.h"
#include "tests/cli/program.h"
#include "tests/support/german_locale.h"
#include "tests/support/test_kind.h"

namespace spinaltap {
namespace {

namespace fs = std::filesystem;

/// Each stage, on a coarse phantom. `plan.json` of the phantom has the paths along its pedicles.
constexpr std::array kCommands{
    "phantom l3 --pixel 0.8 --size 160 --slice-step 1.5 --slices 34 --json phantom.json",
    "segment l3/ct -o l3.seg.nrrd --picture l3.png --json segment.json",
    "points l3/ct -o points.ply",
    "fit points.ply -o l3.rbf --reduce 0.2",
    "eval l3.rbf --grid 2 -o field.nrrd",
    "eval l3.rbf points.ply -o values.csv --gradient",
    "bake l3/ct -o bone.vdb --voxel 0.5",
    "mesh bone.vdb -o bone.stl",
    "plan bone.vdb --auto -o plan.json",
    "grade bone.vdb l3/plan.json -o grade",
    "drill bone.vdb l3/plan.json --path left --ct l3/ct --operator tremor --step 0.02 --spacing 0.2 --splats -o "
    "drilled "
    "--record run.h5",
    "export run.h5 -o run.csv --events events.csv",
    "render drilled/drilled.vdb --plan l3/plan.json --cut path -o cut.png",
    "render bone.vdb --record run.h5 -o remaining.png",
    "study study.json -o study",
};

/// What depends on the clock: how fast cycles were, when a record's blocks were written, which run was done first.
constexpr std::array kByTheClock{"drilled/log.csv", "drilled/report.html", "drilled/files.txt", "run.h5",
                                 "study/part-1-of-1.csv"};

Json study() {
  return {{"format", "spinaltap-study"},
          {"version", 2},
          {"bone", "bone.vdb"},
          {"plan", "l3/plan.json"},
          {"path", "left"},
          {"volume", {{"spacing_mm", 0.2}}},
          {"operator", {{"kind", "feed"}, {"feed_mm_s", 1.0}, {"step_mm", 0.02}, {"tremor_mm", 0.05}}},
          {"design",
           {{"runs", 6},
            {"sampling", "latin-hypercube"},
            {"seed", 3},
            {"factors",
             {{"entry_left_mm", {{"normal", {{"mean", 0.0}, {"deviation", 1.5}}}}},
              {"density_scale", {{"levels", {0.6, 1.0}}}}}}}}};
}

struct Conditions {
  std::string name;
  std::string threads = "1";
  std::string instructions = "portable";
  std::string locale = "C";
  std::string folder = "a";
};

/// Hashes of all files. Without the column of log.csv that the clock fills.
std::map<std::string, std::string> hashes(const Conditions& at, const std::string& locales) {
  const test::TemporaryFolder root;
  const fs::path folder = root.path() / at.folder;
  fs::create_directories(folder);
  write_whole_file(folder / "study.json", study().dump(2));
  std::map<std::string, std::string> found;
  const auto keep = [&](const std::string& name, const std::string& bytes) {
    WordHash64 hash;
    hash.add(bytes.data(), bytes.size());
    found[name] = hash.hex();
  };
  const std::string before =
      "SPINALTAP_INSTRUCTIONS=" + at.instructions + " LC_ALL=" + at.locale + " LOCPATH='" + locales + "'";
  for (const std::string command : kCommands) {
    const test::ProgramRun run = test::run_program(command + " --threads " + at.threads, folder, before);
    EXPECT_EQ(run.exit_code, 0) << at.name << ": " << command << "\n" << run.errors;
  }
  for (const std::string& name : test::everything_in(folder)) {
    if (!fs::is_regular_file(folder / name)) continue;
    if (std::find(kByTheClock.begin(), kByTheClock.end(), name) != kByTheClock.end()) continue;
    keep(name, read_whole_file(folder / name));
  }
  std::istringstream log(read_whole_file(folder / "drilled/log.csv"));
  std::string rows;
  for (std::string line; std::getline(log, line);) rows += line.substr(0, line.rfind(',')) + "\n";
  EXPECT_GT(std::count(rows.begin(), rows.end(), '\n'), 10);
  keep("drilled/log.csv, without its last column", rows);
  return found;
}

WHOLE_RUNS("Determinism.*");

TEST(Determinism, OfEveryFile) {
  const test::GermanLocale german;
  const auto expected = hashes({.name = "as a rule"}, german.path());
  ASSERT_GT(expected.size(), 30U);
  for (const auto& [name, hash] : expected) std::printf("%s  %s\n", hash.c_str(), name.c_str());
  std::vector<Conditions> others{{.name = "two threads", .threads = "2"},
                                 {.name = "another folder", .folder = "some other place/b"}};
  if (instruction_set() > InstructionSet::portable) others.push_back({.name = "AVX2", .instructions = "avx2"});
  if (instruction_set() > InstructionSet::avx2) others.push_back({.name = "AVX-512", .instructions = "avx512"});
  if (german.is_there()) others.push_back({.name = "German", .locale = test::GermanLocale::kName});
  for (const Conditions& other : others) {
    const auto found = hashes(other, german.path());
    EXPECT_EQ(found.size(), expected.size()) << other.name;
    for (const auto& [name, hash] : expected) {
      const auto same = found.find(name);
      ASSERT_NE(same, found.end()) << other.name << ": no " << name;
      EXPECT_EQ(same->second, hash) << other.name << ": " << name;
    }
  }
  if (!german.is_there()) GTEST_SKIP() << "but for another locale: localedef makes no de_DE.UTF-8 here";
}

}  // namespace
}  // namespace spinaltap
