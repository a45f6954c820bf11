#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
#include <string>

#include "core/base/progress.h"
#include "core/study/study_row.h"
#include "core/study/study_shard.h"

namespace spinaltap {

/// Does one run after the other, from one thread; made once for each thread, which then owns it.
using StudyRunner = std::function<StudyRow(std::size_t run)>;

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
