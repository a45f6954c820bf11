// drill --record, killed at any moment: the record opens, holds all but the last second, and replays bit for bit.

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

#include "core/base/error.h"
#include "core/files/json_file.h"
#include "core/files/plan_file.h"
#include "core/session/record/session_record.h"
#include "tests/cli/program.h"
#include "tests/support/made_bone.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr int kKills = 20;
constexpr std::uint64_t kSeed = 20;

double seconds(Clock::duration time) { return std::chrono::duration<double>(time).count(); }

/// A ball of 7 mm and a path through its middle: some 13 s at 1 mm/s.
void write_bone_and_plan(const fs::path& folder) {
  const Vec3 centre_mm(10.0, -4.0, 30.0);
  constexpr double kRadiusMm = 7.0;
  const Vec3 corner = Vec3::Constant(kRadiusMm + 2.0);
  write_bone(test::made_bone([&](const Vec3& p) { return (p - centre_mm).norm() - kRadiusMm; },
                             {centre_mm - corner, centre_mm + corner}, 0.25),
             folder / "bone.vdb");
  const Vec3 direction = Vec3(1.0, 2.0, -2.0) / 3.0;
  write_plan({{"middle", centre_mm - kRadiusMm * direction, centre_mm + (kRadiusMm - 1.0) * direction,
               DrillBit{2.0, 30.0, 2.0}}},
             folder / "plan.json");
}

pid_t start(const fs::path& folder, const std::string& arguments) {
  const pid_t process = ::fork();
  if (process == 0) {
    if (::chdir(folder.c_str()) != 0 || std::freopen("output", "w", stdout) == nullptr ||
        std::freopen("errors", "w", stderr) == nullptr) {
      ::_exit(3);
    }
    const std::string command = std::string("exec '") + SPINALTAP_PROGRAM + "' " + arguments;
    ::execl("/bin/sh", "sh", "-c", command.c_str(), static_cast<char*>(nullptr));
    ::_exit(4);
  }
  return process;
}

/// Follows a record from outside while a session in real time writes it.
class Follower {
 public:
  explicit Follower(fs::path record) : record_(std::move(record)) {}

  /// Reads it once more. False while there is none with a cycle.
  bool look() {
    try {
      const SessionRecord record = read_record(record_);
      if (record.cycles.empty()) return false;
      EXPECT_FALSE(record.is_whole);
      EXPECT_GE(record.cycles.size(), rows_) << "the record became shorter";
      rows_ = record.cycles.size();
      // The session's time goes with the clock: it is at least so far ahead.
      ahead_s_ = std::max(ahead_s_, record.cycles.back().time_s - seconds(Clock::now() - start_));
      return true;
    } catch (const Error&) {
      EXPECT_EQ(rows_, 0U) << "the record cannot be read any more";
      return false;  // it is being made
    }
  }
  /// The session's time now, at least.
  double min_time_s() const { return ahead_s_ + seconds(Clock::now() - start_); }

 private:
  fs::path record_;
  Clock::time_point start_ = Clock::now();
  std::size_t rows_ = 0;
  double ahead_s_ = -1e9;
};

/// Records, and kills after `lifetime_s` of recording. Returns the time that the session had come to, at least.
double record_and_kill(const fs::path& folder, double lifetime_s) {
  const pid_t process = start(folder,
                              "drill ../bone.vdb ../plan.json --radius 1.6 --spacing 0.1 --operator tremor --real-time "
                              "--record run.h5 -o out");
  Follower follower(folder / "run.h5");
  const Clock::time_point begin = Clock::now();
  while (!follower.look() && seconds(Clock::now() - begin) < 120.0 && ::waitpid(process, nullptr, WNOHANG) == 0) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  const Clock::time_point end =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(lifetime_s));
  while (Clock::now() + std::chrono::milliseconds(100) < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    follower.look();
  }
  std::this_thread::sleep_until(end);
  const double time_s = follower.min_time_s();
  ::kill(process, SIGKILL);
  int status = 0;
  ::waitpid(process, &status, 0);
  EXPECT_TRUE(WIFSIGNALED(status)) << "the session was over too soon";
  return time_s;
}

TEST(KilledRecord, OpensHoldsAllButTheLastSecondAndReplays) {
  const test::TemporaryFolder folder;
  write_bone_and_plan(folder.path());
  constexpr std::array kEngines{"ring", "reference", "arc", "leaf"};
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> lifetime_s(0.1, 2.5);
  double max_lost_s = 0.0;
  std::size_t fewest = static_cast<std::size_t>(-1);
  for (int n = 0; n < kKills; ++n) {
    const std::string name = "kill " + std::to_string(n) + " of seed " + std::to_string(kSeed);
    const fs::path here = folder.path() / std::to_string(n);
    fs::create_directory(here);
    const double time_s = record_and_kill(here, lifetime_s(random));
    const SessionRecord record = read_record(here / "run.h5");
    ASSERT_FALSE(record.cycles.empty()) << name;
    EXPECT_FALSE(record.is_whole) << name;
    EXPECT_EQ(record.lost, 0U) << name;
    EXPECT_GE(record.cycles.back().time_s, time_s - 1.0) << name;
    max_lost_s = std::max(max_lost_s, time_s - record.cycles.back().time_s);
    fewest = std::min(fewest, record.cycles.size());

    const std::string how = std::string(" --engine ") + kEngines[static_cast<std::size_t>(n) % kEngines.size()] +
                            " --threads " + std::to_string(1 + n / 4 % 2);
    const test::ProgramRun replay =
        test::run_program("replay run.h5 ../bone.vdb --force --json replay.json" + how, here);
    ASSERT_EQ(replay.exit_code, 0) << name << how << "\n" << replay.output << replay.errors;
    const Json figures = read_json(here / "replay.json");
    EXPECT_EQ(figures["cycles"], record.cycles.size()) << name;
    EXPECT_EQ(figures["is_whole"], false) << name;
    fs::remove_all(here);
  }
  std::printf("%d records, of %zu cycles or more, ended %.3f s before the kill at most\n", kKills, fewest, max_lost_s);
}

}  // namespace
}  // namespace spinaltap
