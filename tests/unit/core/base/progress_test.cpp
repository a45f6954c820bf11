#include "core/base/progress.h"

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <map>
#include <string>

#include "core/base/error.h"

namespace spinaltap {
namespace {

TEST(Progress, ReportsToNobodyByDefaultAndIsNeverCancelled) {
  const Progress progress;
  progress.cancel();
  EXPECT_NO_THROW(progress.report("stage", 0.5));
}

TEST(Progress, ThrowsOnceItIsCancelledInAnyCopy) {
  int calls = 0;
  const Progress progress([&](std::string_view, double) { ++calls; });
  const Progress copy = progress;
  progress.report("stage", 0.1);
  copy.cancel();
  EXPECT_THROW(progress.report("stage", 0.2), Cancelled);
  EXPECT_EQ(calls, 1);
  const Progress silent{Progress::Callback()};
  silent.cancel();
  EXPECT_THROW(silent.report("stage", 0.0), Cancelled);
}

TEST(ProgressCounter, ReportsEveryPercentOnceFromManyThreads) {
  std::map<long, int> seen;
  std::string name;
  bool inside = false;
  const Progress progress([&](std::string_view stage, double share) {
    EXPECT_FALSE(inside);  // calls never overlap
    inside = true;
    name = stage;
    ++seen[std::lround(100.0 * share)];
    inside = false;
  });
  ProgressCounter counter(progress, "counting", 10'000);
  tbb::parallel_for(0, 10'000, [&](int) { counter.add(); });
  EXPECT_EQ(seen.size(), 101U);
  for (const auto& [percent, times] : seen) EXPECT_EQ(times, 1) << percent;
  EXPECT_EQ(name, "counting");
}

TEST(ProgressCounter, ReachesTheEndWithFewPiecesAndWithUnevenOnes) {
  double last = -1.0;
  int calls = 0;
  const Progress progress([&](std::string_view, double share) {
    EXPECT_GT(share, last);
    last = share;
    ++calls;
  });
  ProgressCounter counter(progress, "few", 7);
  counter.add(2);
  counter.add(4);
  counter.add();
  EXPECT_EQ(last, 1.0);
  EXPECT_EQ(calls, 4);
  EXPECT_NO_THROW(ProgressCounter(Progress(), "none", 0).add());
}

}  // namespace
}  // namespace spinaltap
