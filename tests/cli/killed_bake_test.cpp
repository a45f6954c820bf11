// bake, killed at any moment: the old file or none is left, and the next run ends right.

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <thread>

#include "core/base/staged_output.h"
#include "core/ct/dicom_write.h"
#include "core/ct/label_map.h"
#include "tests/cli/program.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

const std::string kFineBake = "bake ../ct --labels ../ball.nrrd --label 2 --voxel 0.15 --force -o bone.vdb";

/// A ball of bone of 4 mm in water, and its label map: the whole chain in a second.
void write_ball(const fs::path& folder) {
  GridGeometry geometry;
  geometry.size = {24, 24, 24};
  std::vector<std::int16_t> hu;
  BoneMask mask{geometry, {}};
  for (int k = 0; k < geometry.size[2]; ++k) {
    for (int j = 0; j < geometry.size[1]; ++j) {
      for (int i = 0; i < geometry.size[0]; ++i) {
        const double depth_mm = 4.0 - (geometry.to_patient(Vec3(i, j, k)) - Vec3(12.1, 11.7, 12.3)).norm();
        hu.push_back(static_cast<std::int16_t>(600.0 * std::clamp(depth_mm + 0.5, 0.0, 1.0)));
        mask.inside.push_back(depth_mm > 0.0 ? 1 : 0);
      }
    }
  }
  fs::create_directory(folder / "ct");
  write_dicom(make_ct_volume(geometry, std::move(hu)), folder / "ct");
  write_whole_file(folder / "ball.nrrd", encode_label_map(mask, 2, "ball.nrrd"));
}

/// Runs bake in `folder` and kills it after `lifetime`. Returns whether it was still running then.
bool bake_and_kill(const fs::path& folder, Clock::duration lifetime) {
  const pid_t process = ::fork();
  if (process == 0) {
    if (::chdir(folder.c_str()) != 0 || std::freopen("/dev/null", "w", stdout) == nullptr) ::_exit(3);
    const std::string command = std::string("exec '") + SPINALTAP_PROGRAM + "' " + kFineBake;
    ::execl("/bin/sh", "sh", "-c", command.c_str(), static_cast<char*>(nullptr));
    ::_exit(4);
  }
  std::this_thread::sleep_for(lifetime);
  ::kill(process, SIGKILL);
  int status = 0;
  ::waitpid(process, &status, 0);
  const bool was_running = WIFSIGNALED(status);
  EXPECT_TRUE(was_running || WEXITSTATUS(status) == 0);
  return was_running;
}

TEST(KilledBake, LeavesTheOldFileOrNoneAndTheNextRunEndsRight) {
  const test::TemporaryFolder folder;
  write_ball(folder.path());
  const fs::path alone = folder.path() / "alone";
  fs::create_directory(alone);
  // How long it takes once the program and its libraries are in memory.
  ASSERT_EQ(test::run_program(kFineBake, alone).exit_code, 0);
  fs::remove_all(alone);
  fs::create_directory(alone);
  const Clock::time_point start = Clock::now();
  const test::ProgramRun whole = test::run_program(kFineBake, alone);
  Clock::duration duration = Clock::now() - start;
  ASSERT_EQ(whole.exit_code, 0) << whole.errors;
  const std::string right = read_whole_file(alone / "bone.vdb");
  EXPECT_EQ(test::everything_in(alone), std::vector<std::string>{"bone.vdb"});

  constexpr int kKills = 20;
  constexpr int kMostRuns = 60;
  const std::string old = "an older bone";
  int killed = 0;
  int resumed = 0;
  int runs = 0;
  for (; killed < kKills && runs < kMostRuns; ++runs) {
    const fs::path here = folder.path() / std::to_string(runs);
    fs::create_directory(here);
    const fs::path bone = here / "bone.vdb";
    const bool has_old = runs % 2 == 1;
    if (has_old) write_whole_file(bone, old);
    const bool was_running = bake_and_kill(here, duration * (2 * killed + 1) / (2 * kKills));
    if (was_running) {
      ++killed;
    } else {
      // Another program may have slowed the run that was timed.
      duration -= duration / 5;
    }
    if (fs::exists(bone)) {
      const std::string left = read_whole_file(bone);
      EXPECT_TRUE((has_old && left == old) || left == right) << "run " << runs << " left another file";
    } else {
      EXPECT_FALSE(has_old) << "run " << runs << " took the old file away";
    }
    const test::ProgramRun next = test::run_program(kFineBake + " --json run.json", here);
    ASSERT_EQ(next.exit_code, 0) << next.errors;
    EXPECT_EQ(read_whole_file(bone), right) << "after run " << runs;
    resumed += read_whole_file(here / "run.json").find("\"fit_from_cache\": true") != std::string::npos ? 1 : 0;
    // Nothing of the killed run stays.
    EXPECT_EQ(test::everything_in(here), (std::vector<std::string>{"bone.vdb", "run.json"})) << "after run " << runs;
  }
  std::printf("%d of %d runs were killed at work, %d went on from a finished fit\n", killed, runs, resumed);
  EXPECT_EQ(killed, kKills);
}

}  // namespace
}  // namespace spinaltap
