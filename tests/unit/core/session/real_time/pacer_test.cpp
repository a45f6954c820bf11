#include "core/session/real_time/pacer.h"

#include <gtest/gtest.h>

#include <chrono>
#include <numeric>
#include <thread>

#include "core/session/real_time/timing.h"

namespace spinaltap {
namespace {

constexpr std::int64_t kMs = 1'000'000;

void spin_until(std::int64_t time_ns) {
  while (wall_ns() < time_ns) {
  }
}

TEST(Pacer, BeginsNoCycleBeforeItIsDueAndDriftsNotAtAll) {
  const std::int64_t start_ns = wall_ns() + 2 * kMs;
  Pacer pacer(start_ns, 300.0);  // of a period that is no whole number of ns
  std::uint64_t next = 0;
  for (int n = 0; n < 60; ++n) {
    next += pacer.wait();
    const double begin = 300.0 * 1e-9 * static_cast<double>(pacer.begin_ns() - start_ns);
    // The last that came due is the one that is served: neither early nor one behind. A ns of rounding.
    EXPECT_GE(begin, static_cast<double>(next - 1) - 1e-6);
    EXPECT_LT(begin, static_cast<double>(next));
    pacer.finish(true);
  }
  const PaceReport report = pacer.report();
  EXPECT_EQ(report.cycles, 60U);
  EXPECT_EQ(report.cycles + report.skipped, next);
}

TEST(Pacer, CountsEveryDueTimeAsCycleIdleOrSkipped) {
  const std::int64_t start_ns = wall_ns();
  Pacer pacer(start_ns, 1000.0);
  std::uint64_t due = 0;
  for (int n = 0; n < 40; ++n) {
    due += pacer.wait();
    if (n % 10 == 3) spin_until(wall_ns() + 5 * kMs);  // over four more due times
    pacer.finish(n % 2 == 1);
  }
  const PaceReport report = pacer.report();
  EXPECT_EQ(report.cycles, 20U);
  EXPECT_EQ(report.idle, 20U);
  EXPECT_GE(report.skipped, 4U * 4U);
  EXPECT_EQ(report.cycles + report.idle + report.skipped, due);
  EXPECT_GE(report.missed, 4U);
  EXPECT_GE(report.work_wall.max_us, 5000.0);
  EXPECT_GE(report.work_cpu.max_us, 1000.0);  // it spun; on a full machine others ran too
  const auto sum = [](const std::vector<std::uint64_t>& counts) {
    return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
  };
  EXPECT_EQ(sum(report.work_histogram), report.cycles);
  EXPECT_EQ(sum(report.wake_up_histogram), report.cycles + report.idle);
}

TEST(Pacer, MeasuresHowLateACycleBeganFromWhenItWasDueAndNotFromTheOneItServes) {
  const std::int64_t start_ns = wall_ns() - 50 * kMs;
  Pacer pacer(start_ns, 1000.0);
  EXPECT_GE(pacer.wait(), 50U);
  pacer.finish(true);
  const PaceReport report = pacer.report();
  EXPECT_GE(report.wake_up.max_us, 50'000.0);
  EXPECT_GE(report.skipped, 49U);
}

TEST(Pacer, TellsWorkFromWaiting) {
  Pacer pacer(wall_ns(), 1000.0);
  pacer.wait();
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  pacer.finish(true);
  const PaceReport report = pacer.report();
  EXPECT_GE(report.work_wall.max_us, 20'000.0);
  EXPECT_LT(report.work_cpu.max_us, 10'000.0);
  EXPECT_EQ(report.missed, 1U);
}

}  // namespace
}  // namespace spinaltap
