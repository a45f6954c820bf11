#include "core/study/study_work.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <chrono>
#include <numeric>
#include <set>
#include <thread>
#include <vector>

#include "core/base/error.h"

namespace spinaltap {
namespace {

std::vector<std::size_t> numbers(std::size_t count) {
  std::vector<std::size_t> runs(count);
  std::iota(runs.begin(), runs.end(), std::size_t{0});
  return runs;
}

StudyRow row_of(std::size_t run) {
  StudyRow row;
  row[StudyColumn::run] = static_cast<double>(run);
  return row;
}

/// A run that shares work out, as drilling engines do, and notes whether another run began inside it.
class Nested {
 public:
  StudyRunner runner() {
    ++runners_;
    return [this, busy = false](std::size_t run) mutable {
      if (busy) entered_ = true;
      busy = true;
      const std::thread::id own = std::this_thread::get_id();
      tbb::parallel_for(0, 64, [&](int) {
        if (std::this_thread::get_id() != own) shared_ = true;
        std::this_thread::sleep_for(std::chrono::microseconds(20));
      });
      busy = false;
      return row_of(run);
    };
  }
  int runners() const { return runners_; }
  bool shared() const { return shared_; }
  bool entered() const { return entered_; }

 private:
  std::atomic<int> runners_{0};
  std::atomic<bool> shared_{false}, entered_{false};
};

TEST(StudyWork, DoesEveryRunOnceAndWholeOnOneThread) {
  const tbb::global_control allow(tbb::global_control::max_allowed_parallelism, 4);
  Nested nested;
  std::multiset<std::size_t> done;
  const std::vector<std::size_t> runs = numbers(40);
  const StudyWork work = do_study_runs(
      runs, [&] { return nested.runner(); }, [&](const StudyRow& row) { done.insert(row.run()); });
  EXPECT_EQ(work.runs, 40U);
  EXPECT_EQ(work.threads, 4);
  EXPECT_EQ(done, std::multiset<std::size_t>(runs.begin(), runs.end()));
  EXPECT_FALSE(nested.shared());
  EXPECT_FALSE(nested.entered());
  EXPECT_LE(nested.runners(), 4);
  EXPECT_GT(work.seconds, 0.0);
}

TEST(StudyWork, UsesAllThreadsThatAreAllowedAtOnce) {
  for (const int threads : {1, 3}) {
    const tbb::global_control allow(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    std::atomic<int> now{0}, max{0};
    // A thread that waits for a processor comes late: the first runs wait for it.
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    do_study_runs(
        numbers(24),
        [&] {
          return [&](std::size_t run) {
            int seen = max;
            const int here = ++now;
            while (here > seen && !max.compare_exchange_weak(seen, here)) {
            }
            do {
              std::this_thread::sleep_for(std::chrono::milliseconds(1));
            } while (max < threads && std::chrono::steady_clock::now() < deadline);
            --now;
            return row_of(run);
          };
        },
        [](const StudyRow&) {});
    EXPECT_EQ(max, threads);
  }
}

TEST(StudyWork, StopsAtTheFirstErrorAndKeepsWhatWasDone) {
  const tbb::global_control allow(tbb::global_control::max_allowed_parallelism, 3);
  std::size_t done = 0;
  const auto make = [] {
    return [](std::size_t run) {
      if (run == 10) throw Error("run 10 is bad");
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      return row_of(run);
    };
  };
  EXPECT_THROW(do_study_runs(numbers(1000), make, [&](const StudyRow&) { ++done; }), Error);
  EXPECT_LT(done, 30U);
  EXPECT_GE(done, 8U);
}

TEST(StudyWork, CanBeCancelled) {
  std::size_t done = 0;
  const Progress progress([](std::string_view, double) {});
  EXPECT_THROW(do_study_runs(
                   numbers(1000), [] { return [](std::size_t run) { return row_of(run); }; },
                   [&](const StudyRow&) {
                     if (++done == 5) progress.cancel();
                   },
                   progress),
               Cancelled);
  EXPECT_LT(done, 20U);
}

TEST(StudyWork, FinishesRunsUnderWayWhereItIsAskedToStop) {
  const tbb::global_control allow(tbb::global_control::max_allowed_parallelism, 3);
  std::atomic<std::size_t> begun{0};
  std::atomic<bool> is_asked{false};
  std::set<std::size_t> done;
  const auto make = [&] {
    return [&](std::size_t run) {
      if (++begun == 10) is_asked = true;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      return row_of(run);
    };
  };
  const StudyWork work = do_study_runs(
      numbers(1000), make, [&](const StudyRow& row) { done.insert(row.run()); }, {}, [&] { return is_asked.load(); });
  EXPECT_TRUE(work.is_stopped);
  EXPECT_EQ(done.size(), begun) << "every run that was begun is handed over";
  EXPECT_EQ(work.runs, done.size());
  EXPECT_GE(begun, 10U);
  EXPECT_LT(begun, 14U);
  // Asked when nothing is left, it has done all.
  is_asked = false;
  begun = 1000;
  const StudyWork whole = do_study_runs(
      numbers(5), make, [&](const StudyRow&) { is_asked = begun == 1005; }, {}, [&] { return is_asked.load(); });
  EXPECT_FALSE(whole.is_stopped);
  EXPECT_EQ(whole.runs, 5U);
}

TEST(StudyWork, TellsRateAndTimeLeft) {
  std::string last;
  double share = 0.0;
  const Progress progress([&](std::string_view stage, double fraction) {
    last = stage;
    share = fraction;
  });
  do_study_runs(
      numbers(4), [] { return [](std::size_t run) { return row_of(run); }; }, [](const StudyRow&) {}, progress);
  EXPECT_TRUE(last.starts_with("runs: ")) << last;
  EXPECT_NE(last.find(" a second, 0 s left"), std::string::npos) << last;
  EXPECT_EQ(share, 1.0);
}

}  // namespace
}  // namespace spinaltap
