#include "core/session/real_time/real_time.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/resource.h>
#include <tbb/parallel_for.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <mutex>
#include <set>
#include <thread>

#include "core/base/error.h"
#include "core/session/drill_session.h"
#include "core/session/real_time/timing.h"

namespace spinaltap {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

const Vec3 kEntry(12.0, 80.0, -300.0);
const Vec3 kEntryAxis = Vec3(-0.2, -0.9, 0.3).normalized();

DrillPath short_path() { return {"short", kEntry, kEntry + 8.0 * kEntryAxis, {3.0, 30.0, 3.0}}; }

/// A cylinder of even bone of 300 HU around a path of 8 mm, and its session.
struct SmallDrilling {
  explicit SmallDrilling(const SessionOptions& options = {}) {
    PointVolume& volume = volumes.emplace_back(short_path(), PointVolumeOptions{.radius_mm = 2.5, .spacing_mm = 0.25});
    for (int disc = 0; disc < volume.disc_count(); ++disc) {
      for (std::size_t n = 0; n < volume.pattern().point_count(); ++n) volume.set_hu(disc, n, 300.0);
    }
    session = std::make_unique<DrillSession>(short_path(), volumes,
                                             make_ring_engine(volumes.front(), short_path().bit, Material()),
                                             Material(), nullptr, options);
  }
  std::vector<PointVolume> volumes;
  std::unique_ptr<DrillSession> session;
};

/// Along the path at 10 mm/s, 1000 poses a second; ends after so many, or when it is asked to stop.
class StraightOperator final : public Operator {
 public:
  explicit StraightOperator(std::size_t poses) : poses_(poses) {}

  std::optional<ToolInput> next(const ToolFeedback& feedback) override {
    if (given_ >= poses_ || feedback.stop) return std::nullopt;
    const double depth_mm = std::min(0.01 * static_cast<double>(given_++), 8.0);
    return ToolInput{.pose = {kEntry + depth_mm * kEntryAxis, kEntryAxis}, .dt_s = 0.001};
  }
  std::size_t count() const override { return poses_; }
  std::size_t given() const { return given_; }

 private:
  std::size_t poses_;
  std::size_t given_ = 0;
};

constexpr std::size_t kEndless = 1'000'000;

std::uint64_t due_times(const PaceReport& pace) { return pace.cycles + pace.idle + pace.skipped; }

TEST(RealTime, EndsWithTheOperatorAndDrillsItsLastPose) {
  SmallDrilling drilling;
  StraightOperator tool_operator(301);
  const RealTimeReport report = run_real_time(*drilling.session, tool_operator, {});
  EXPECT_EQ(tool_operator.given(), 301U);
  EXPECT_NEAR(drilling.session->last().depth_mm, 3.0, 1e-9);
  EXPECT_NEAR(drilling.session->last().time_s, 0.3, 1e-9);
  EXPECT_GE(report.seconds, 0.3);
  EXPECT_EQ(report.display.cycles, 0U);
  EXPECT_EQ(report.output.cycles, 0U);
}

TEST(RealTime, EndsAfterTheLongestTime) {
  SmallDrilling drilling;
  StraightOperator tool_operator(kEndless);
  const RealTimeReport report = run_real_time(*drilling.session, tool_operator, {.longest_s = 0.15});
  EXPECT_GE(report.seconds, 0.15);
  EXPECT_LT(report.seconds, 5.0);  // on a full machine
}

TEST(RealTime, EndsWhenItIsCancelled) {
  SmallDrilling drilling;
  StraightOperator tool_operator(kEndless);
  std::atomic<int> reports{0};
  std::optional<Progress> progress;
  progress.emplace([&](std::string_view, double share) {
    EXPECT_GE(share, 0.0);
    EXPECT_LE(share, 1.0);
    if (++reports == 3) progress->cancel();
  });
  EXPECT_THROW(run_real_time(*drilling.session, tool_operator, {}, {}, {}, {}, *progress), Cancelled);
  EXPECT_EQ(reports, 3);
  const std::uint64_t cycles = drilling.session->last().index;
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_EQ(drilling.session->last().index, cycles);  // no thread goes on
}

TEST(RealTime, CountsEveryDueTimeOfEveryThread) {
  SmallDrilling drilling;
  StraightOperator tool_operator(kEndless);
  std::uint64_t observed = 0;
  const RealTimeReport report = run_real_time(
      *drilling.session, tool_operator,
      {.rate_hz = 800.0, .tool_rate_hz = 1000.0, .output_rate_hz = 5000.0, .longest_s = 0.4},
      [&](const Cycle&) { ++observed; }, [](const Cycle&) {}, [](const Vec3&) {});
  // All end by the same second; each may end a cycle before or after, and sleeps may take some milliseconds.
  const auto expect_all = [&](const PaceReport& pace, double rate_hz) {
    EXPECT_GE(static_cast<double>(due_times(pace)), rate_hz * 0.4 - 3.0) << rate_hz;
    EXPECT_LE(static_cast<double>(due_times(pace)), rate_hz * (report.seconds + 0.1) + 3.0) << rate_hz;
  };
  expect_all(report.collision, 800.0);
  expect_all(report.tool, 1000.0);
  expect_all(report.display, 60.0);
  expect_all(report.output, 5000.0);
  EXPECT_EQ(observed, report.collision.cycles + 1);  // and the first, before the clock
  EXPECT_NEAR(report.collision.rate_hz * report.seconds, static_cast<double>(report.collision.cycles),
              0.05 * static_cast<double>(report.collision.cycles));
}

TEST(RealTime, ShowsCyclesThatTookTooLongAsMissed) {
  SmallDrilling drilling;
  StraightOperator tool_operator(200);
  int cycles = 0;
  const RealTimeReport report = run_real_time(*drilling.session, tool_operator, {}, [&](const Cycle&) {
    if (++cycles % 10 != 0) return;
    const std::int64_t until_ns = wall_ns() + 5'000'000;
    while (wall_ns() < until_ns) {
    }
  });
  // Of five periods each: the cycle is missed, and of the next four at most one is not skipped.
  const auto slow = static_cast<std::uint64_t>(cycles / 10);
  EXPECT_GE(slow, 3U);
  EXPECT_GE(report.collision.missed, slow);
  EXPECT_GE(report.collision.skipped, 3 * slow);
  EXPECT_GE(report.collision.work_wall.max_us, 5000.0);
  EXPECT_GE(report.collision.wake_up.max_us, 3000.0);
}

TEST(RealTime, TakesTheLastOfSeveralPosesWithTheTimeOfAll) {
  SmallDrilling drilling;
  StraightOperator tool_operator(401);
  std::vector<double> dt_s;
  const RealTimeReport report = run_real_time(*drilling.session, tool_operator, {.rate_hz = 100.0},
                                              [&](const Cycle& cycle) { dt_s.push_back(cycle.input.dt_s); });
  EXPECT_LE(report.collision.cycles, 45U);
  EXPECT_NEAR(drilling.session->last().time_s, 0.4, 1e-9);
  EXPECT_NEAR(drilling.session->last().depth_mm, 4.0, 1e-9);
  double sum_s = 0.0;
  for (std::size_t n = 1; n < dt_s.size(); ++n) sum_s += dt_s[n];
  EXPECT_NEAR(sum_s, 0.4, 1e-9);
  EXPECT_GT(*std::max_element(dt_s.begin() + 1, dt_s.end()), 0.0089);
}

TEST(RealTime, DoesNothingWhereThereIsNoNewPose) {
  SmallDrilling drilling;
  StraightOperator tool_operator(50);
  const RealTimeReport report =
      run_real_time(*drilling.session, tool_operator, {.rate_hz = 2000.0, .tool_rate_hz = 200.0});
  EXPECT_LE(report.collision.cycles, 49U);  // the first is before the clock
  EXPECT_GT(report.collision.idle, 0U);
  EXPECT_NEAR(drilling.session->last().time_s, 0.049, 1e-9);
}

TEST(RealTime, BringsWhatLockStepBringsForTheInputsThatItTook) {
  SmallDrilling drilling;
  StraightOperator tool_operator(601);
  std::vector<Cycle> cycles;
  cycles.reserve(700);
  run_real_time(*drilling.session, tool_operator, {.rate_hz = 700.0},
                [&](const Cycle& cycle) { cycles.push_back(cycle); });

  class Replayed final : public Operator {
   public:
    explicit Replayed(const std::vector<Cycle>& cycles) : cycles_(cycles) {}
    std::optional<ToolInput> next(const ToolFeedback&) override {
      return at_ < cycles_.size() ? std::optional(cycles_[at_++].input) : std::nullopt;
    }

   private:
    const std::vector<Cycle>& cycles_;
    std::size_t at_ = 0;
  };
  SmallDrilling again;
  Replayed replayed(cycles);
  std::size_t at = 0;
  std::size_t removed = 0;
  run_session(*again.session, replayed, [&](const Cycle& cycle) {
    const Cycle& before = cycles.at(at++);
    ASSERT_EQ(cycle.step.removed, before.step.removed);
    ASSERT_EQ(cycle.force.force_n, before.force.force_n);
    ASSERT_EQ(cycle.time_s, before.time_s);
    removed += cycle.step.removed;
  });
  EXPECT_EQ(at, cycles.size());
  EXPECT_GT(removed, 1000U);
}

TEST(RealTime, LetsTheOperatorKnowThatItShallStop) {
  SessionOptions options;
  options.stop.thrust_n = 1.0;  // in bone, from the first tenths of a millimetre on
  SmallDrilling drilling(options);
  StraightOperator tool_operator(kEndless);
  run_real_time(*drilling.session, tool_operator, {.longest_s = 5.0});
  EXPECT_TRUE(drilling.session->is_stopped());
  EXPECT_LT(tool_operator.given(), 2000U);
}

TEST(RealTime, SharesNoCycleOutToOrdinaryThreads) {
  SmallDrilling drilling;
  StraightOperator tool_operator(50);
  std::mutex mutex;
  std::set<std::thread::id> threads;
  run_real_time(*drilling.session, tool_operator, {.rate_hz = 100.0, .tool_rate_hz = 100.0}, [&](const Cycle&) {
    // As a long step of an engine does, on the thread that steps.
    tbb::parallel_for(0, 64, [&](int) {
      std::this_thread::sleep_for(std::chrono::microseconds(50));
      const std::lock_guard lock(mutex);
      threads.insert(std::this_thread::get_id());
    });
  });
  EXPECT_EQ(threads.size(), 1U);
}

TEST(RealTime, DoesNotWaitForASlowDisplay) {
  SmallDrilling drilling;
  StraightOperator tool_operator(kEndless);
  std::vector<std::uint64_t> shown;
  const RealTimeReport report =
      run_real_time(*drilling.session, tool_operator, {.longest_s = 0.5}, {}, [&](const Cycle& cycle) {
        shown.push_back(cycle.index);
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
      });
  EXPECT_LE(report.display.cycles, 7U);
  EXPECT_EQ(shown.size(), report.display.cycles);
  EXPECT_TRUE(std::is_sorted(shown.begin(), shown.end()));
  EXPECT_GT(report.collision.cycles, 20 * report.display.cycles);
  EXPECT_GE(report.display.missed, 1U);
}

TEST(RealTime, GivesForcesAtTheRateOfADevice) {
  SmallDrilling drilling;
  StraightOperator tool_operator(kEndless);
  std::uint64_t calls = 0;
  double max_n = 0.0;
  double max_cycle_n = 0.0;
  const RealTimeReport report = run_real_time(
      *drilling.session, tool_operator, {.output_rate_hz = 5000.0, .longest_s = 0.3},
      [&](const Cycle& cycle) { max_cycle_n = std::max(max_cycle_n, cycle.force.force_n.norm()); }, {},
      [&](const Vec3& force_n) {
        ++calls;
        max_n = std::max(max_n, force_n.norm());
      });
  EXPECT_EQ(calls, report.output.cycles);
  EXPECT_GT(calls, report.collision.cycles);
  EXPECT_GT(max_n, 0.0);
  EXPECT_LE(max_n, max_cycle_n * (1.0 + 1e-12));  // never longer than the longer of the last two
}

TEST(RealTime, ThrowsWhatTheOperatorOrTheObserverThrows) {
  class Broken final : public Operator {
   public:
    std::optional<ToolInput> next(const ToolFeedback&) override {
      if (++asked_ > 20) fail("the device is gone");
      return ToolInput{.pose = {kEntry, kEntryAxis}};
    }

   private:
    int asked_ = 0;
  };
  SmallDrilling drilling;
  Broken broken;
  EXPECT_THAT([&] { run_real_time(*drilling.session, broken, {}); }, ThrowsMessage<Error>(HasSubstr("device is gone")));
  StraightOperator tool_operator(kEndless);
  EXPECT_THAT([&] { run_real_time(*drilling.session, tool_operator, {}, [](const Cycle&) { fail("no room"); }); },
              ThrowsMessage<Error>(HasSubstr("no room")));
}

TEST(RealTime, EndsAtOnceWithAnOperatorThatHasNoPose) {
  SmallDrilling drilling;
  StraightOperator tool_operator(0);
  const RealTimeReport report = run_real_time(*drilling.session, tool_operator, {});
  EXPECT_EQ(report.collision.cycles, 0U);
  EXPECT_LT(report.seconds, 5.0);
}

TEST(RealTime, RejectsRatesOutOfRange) {
  SmallDrilling drilling;
  StraightOperator tool_operator(10);
  const auto run = [&](const RealTimeOptions& options) { run_real_time(*drilling.session, tool_operator, options); };
  for (const double rate_hz : {0.0, 0.9, -1.0, 20'001.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THAT([&] { run({.rate_hz = rate_hz}); }, ThrowsMessage<Error>(HasSubstr("for collisions")));
    EXPECT_THAT([&] { run({.tool_rate_hz = rate_hz}); }, ThrowsMessage<Error>(HasSubstr("for the tool")));
    EXPECT_THAT([&] { run({.display_rate_hz = rate_hz}); }, ThrowsMessage<Error>(HasSubstr("for the display")));
  }
  EXPECT_THAT([&] { run({.output_rate_hz = 30'000.0}); }, ThrowsMessage<Error>(HasSubstr("output of forces")));
  EXPECT_THAT([&] { run({.longest_s = 0.0}); }, ThrowsMessage<Error>(HasSubstr("longest time")));
  EXPECT_EQ(tool_operator.given(), 0U);
}

TEST(RealTime, GivesBackPriorityAndMemoryAndSaysWhatItHad) {
  SmallDrilling drilling;
  StraightOperator tool_operator(20);
  const RealTimeReport report = run_real_time(*drilling.session, tool_operator, {.wants_priority = true});
  EXPECT_EQ(sched_getscheduler(0), SCHED_OTHER);
  EXPECT_EQ(report.warnings.size(), (report.has_priority ? 0U : 1U) + (report.has_locked_memory ? 0U : 1U));
  const RealTimeReport without = run_real_time(*drilling.session, tool_operator, {});
  EXPECT_FALSE(without.has_priority);
  EXPECT_FALSE(without.has_locked_memory);
  EXPECT_TRUE(without.warnings.empty());
}

#if defined(SPINALTAP_ADDRESS_SANITIZER) || defined(SPINALTAP_THREAD_SANITIZER)
constexpr bool kLocksMemory = true;  // a sanitizer's mlockall() does nothing, and says that it did
#else
constexpr bool kLocksMemory = false;
#endif

/// As a user without rights, in a process of its own: 0 where the run went on and said what it lacked.
int run_without_rights() {
  constexpr uid_t kNobody = 65534;
  const rlimit none{0, 0};
  if (setrlimit(RLIMIT_RTPRIO, &none) != 0 || setrlimit(RLIMIT_MEMLOCK, &none) != 0) return 2;
  if (geteuid() == 0 && setuid(kNobody) != 0) return 3;
  SmallDrilling drilling;
  StraightOperator tool_operator(20);
  const RealTimeReport report = run_real_time(*drilling.session, tool_operator, {.wants_priority = true});
  if (report.has_priority || report.has_locked_memory != kLocksMemory) return 4;
  if (report.warnings.size() != (kLocksMemory ? 1U : 2U)) return 4;
  if (report.warnings[0].find("ulimit -r is 0") == std::string::npos) return 5;
  if (!kLocksMemory && report.warnings[1].find("ulimit -l is 0") == std::string::npos) return 6;
  return report.collision.cycles > 0 ? 0 : 7;
}

TEST(RealTimeDeathTest, GoesOnWithoutRightsAndSaysWhichItLacks) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(std::exit(run_without_rights()), testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace spinaltap
