#include "core/session/real_time/timing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

#include "core/base/random.h"

namespace spinaltap {
namespace {

TEST(TimeHistogram, IsEmptyWithoutTimes) {
  const TimeHistogram times;
  EXPECT_EQ(times.count(), 0U);
  EXPECT_EQ(times.spread().max_us, 0.0);
  EXPECT_TRUE(times.octaves().empty());
}

TEST(TimeHistogram, HasPercentilesWithinOnePercentOfThoseOfAllTimes) {
  // From 20 ns to 2 s, evenly on a logarithmic scale, as no real latencies are spread.
  std::vector<std::int64_t> all;
  TimeHistogram times;
  for (std::uint64_t n = 0; n < 100'000; ++n) {
    all.push_back(static_cast<std::int64_t>(20.0 * std::pow(1e8, random_uniform(7, n))));
    times.add(all.back());
  }
  const TimeSpread exact = spread_of(all);
  const TimeSpread found = times.spread();
  const auto expect_close = [](double found_us, double exact_us) {
    EXPECT_GE(found_us, exact_us);
    EXPECT_LE(found_us, 1.01 * exact_us);
  };
  expect_close(found.p50_us, exact.p50_us);
  expect_close(found.p99_us, exact.p99_us);
  expect_close(found.p999_us, exact.p999_us);
  EXPECT_EQ(found.max_us, exact.max_us);
  EXPECT_EQ(times.count(), all.size());
}

TEST(TimeHistogram, IsExactForOneTime) {
  for (const std::int64_t time_ns : {0L, 1L, 127L, 128L, 255L, 256L, 257L, 1'000'000'007L, 600'000'000'000L}) {
    TimeHistogram times;
    times.add(time_ns);
    EXPECT_EQ(times.spread().p50_us, 1e-3 * static_cast<double>(time_ns)) << time_ns;
    EXPECT_EQ(times.spread().max_us, 1e-3 * static_cast<double>(time_ns)) << time_ns;
  }
}

TEST(TimeHistogram, CountsOctavesOfMicroseconds) {
  TimeHistogram times;
  for (const std::int64_t time_ns : {0, 1'999, 2'000, 3'999, 4'000, 1'000'000, 1'023'999, 1'024'000}) {
    times.add(time_ns);
  }
  EXPECT_EQ(times.octaves(), (std::vector<std::uint64_t>{2, 2, 1, 0, 0, 0, 0, 0, 0, 2, 1}));
}

TEST(TimeHistogram, TakesClocksThatWentBackAndTimesBeyondItsEnd) {
  TimeHistogram times;
  times.add(-5);
  times.add(std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(times.spread().p50_us, 0.0);
  EXPECT_EQ(times.spread().max_us, 1e-3 * static_cast<double>(std::numeric_limits<std::int64_t>::max()));
  const std::vector<std::uint64_t> octaves = times.octaves();
  EXPECT_EQ(std::accumulate(octaves.begin(), octaves.end(), std::uint64_t{0}), 2U);
}

}  // namespace
}  // namespace spinaltap
