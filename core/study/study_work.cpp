#include "core/study/study_work.h"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <mutex>
#include <string>

#include "core/base/text_writer.h"

namespace spinaltap {
namespace {

using Clock = std::chrono::steady_clock;

double cpu_seconds() {
  timespec time{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// "runs: 18.2 a second, 32 s left"
std::string stage_of(double seconds, std::size_t done, std::size_t all) {
  const double rate = static_cast<double>(done) / std::max(seconds, 1e-9);
  return "runs: " + short_text(rate, 3) + " a second, " + fixed_text(static_cast<double>(all - done) / rate, 0) +
         " s left";
}

}  // namespace

StudyWork do_study_runs(std::span<const std::size_t> runs, const std::function<StudyRunner()>& make_runner,
                        const std::function<void(const StudyRow&)>& finished, const Progress& progress,
                        const StudyStop& stops, const StudyPlace& place) {
  const std::size_t all_runs = place.all > 0 ? place.all : runs.size();
  const std::size_t allowed = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  const std::size_t threads = std::clamp<std::size_t>(runs.size(), 1, std::max<std::size_t>(allowed, 1));
  StudyWork work{.threads = static_cast<int>(threads)};
  const Clock::time_point start = Clock::now();
  const double cpu_start = cpu_seconds();
  std::atomic<std::size_t> next{0};
  std::atomic<bool> has_failed{false};
  std::atomic<bool> is_stopped{false};
  std::mutex mutex;  // of `finished`, `work` and the stage's words
  // Which take as long to write as the shortest runs' rows: a dozen times a second is enough for who reads them.
  constexpr double kWordsApartS = 0.08;
  std::string stage;
  double next_words_s = 0.0;
  const auto work_on = [&] {
    const StudyRunner runner = make_runner();
    for (std::size_t n = next++; n < runs.size() && !has_failed; n = next++) {
      if (is_stopped || (stops && stops())) {
        is_stopped = true;
        return;
      }
      const StudyRow row = runner(runs[n]);
      const std::lock_guard lock(mutex);
      if (has_failed) return;
      finished(row);
      ++work.runs;
      const std::size_t done = place.before + work.runs;
      const double seconds = seconds_since(start);
      if (seconds >= next_words_s || work.runs == runs.size()) {
        stage = stage_of(seconds, work.runs, all_runs - place.before);
        next_words_s = seconds + kWordsApartS;
      }
      progress.report(stage, static_cast<double>(done) / static_cast<double>(all_runs));
    }
  };
  const auto work_alone = [&](std::size_t) {
    // An arena of one thread: what a run itself would share out stays here, and nobody else's run is taken up while it
    // waits.
    tbb::task_arena alone(1);
    try {
      alone.execute(work_on);
    } catch (...) {
      has_failed = true;
      throw;
    }
  };
  // As many as are allowed, even where that is more than there are cores.
  tbb::task_arena all(static_cast<int>(threads));
  all.execute([&] { tbb::parallel_for(std::size_t{0}, threads, work_alone, tbb::simple_partitioner()); });
  work.is_stopped = is_stopped;
  work.seconds = seconds_since(start);
  work.cpu_seconds = cpu_seconds() - cpu_start;
  return work;
}

}  // namespace spinaltap
