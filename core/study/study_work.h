#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
#include <string>

#include "core/base/progress.h"
#include "core/study/study_row.h"

namespace spinaltap {

/// What the runs took.
struct StudyWork {
  std::size_t runs = 0;
  int threads = 1;
  double seconds = 0.0;                   ///< by the clock
  double cpu_seconds = 0.0;               ///< of the whole process
  bool is_stopped = false;                ///< runs are left, since it was asked to stop
  std::filesystem::path unlocked_part{};  ///< where the file system has no locks: the file of rows that is ours alone
};

/// Does one run after the other, from one thread; made once for each thread, which then owns it.
using StudyRunner = std::function<StudyRow(std::size_t run)>;

/// Asked before each run, from any thread: true where no further one shall begin.
using StudyStop = std::function<bool()>;

/// Where runs stand among more of them, for what is reported: how many were done before, of how many. 0 of 0: alone.
struct StudyPlace {
  std::size_t before = 0;
  std::size_t all = 0;
};

/// Does runs on all threads that TBB is allowed, each whole run on one of them, the lowest numbers first. `finished` is
/// called with each row, one at a time, in the order in which they end. Reports the stage "runs: ..." with their rate
/// and the time left. Throws what a run or `finished` throws, and Cancelled; rows handed over before count.
/// Where `stops` comes true, runs under way are finished and handed over, and the others are left.
StudyWork do_study_runs(std::span<const std::size_t> runs, const std::function<StudyRunner()>& make_runner,
                        const std::function<void(const StudyRow&)>& finished, const Progress& progress = {},
                        const StudyStop& stops = {}, const StudyPlace& place = {});

}  // namespace spinaltap
