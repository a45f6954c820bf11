#pragma once

#include <cstddef>
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
  double seconds = 0.0;      ///< by the clock
  double cpu_seconds = 0.0;  ///< of the whole process
};

/// Does one run after the other, from one thread; made once for each thread, which then owns it.
using StudyRunner = std::function<StudyRow(std::size_t run)>;

/// Does runs on all threads that TBB is allowed, each whole run on one of them, the lowest numbers first. `finished` is
/// called with each row, one at a time, in the order in which they end. Reports the stage "runs: ..." with their rate
/// and the time left. Throws what a run or `finished` throws, and Cancelled; rows handed over before count.
StudyWork do_study_runs(std::span<const std::size_t> runs, const std::function<StudyRunner()>& make_runner,
                        const std::function<void(const StudyRow&)>& finished, const Progress& progress = {});

}  // namespace spinaltap
