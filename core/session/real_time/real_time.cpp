#include "core/session/real_time/real_time.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "core/base/error.h"
#include "core/force/force_output.h"
#include "core/session/drill_session.h"
#include "core/session/real_time/detail/latest_value.h"
#include "core/session/real_time/detail/thread_team.h"
#include "core/session/real_time/pacer.h"
#include "core/session/real_time/timing.h"

namespace spinaltap {
namespace {

// Who must not wait for whom: a device's forces for anyone, the operator for a long cycle.
constexpr int kOutputPriority = 53;
constexpr int kToolPriority = 52;
constexpr int kCollisionPriority = 51;
constexpr int kNoPriority = 0;

/// An input, how many came before it, and the operator's time at it.
struct TimedInput {
  ToolInput input;
  std::uint64_t index = 0;
  double time_s = 0.0;
};

/// A force, and when the cycle that brought it began, s since the start.
struct TimedForce {
  Vec3 force_n = Vec3::Zero();
  double time_s = 0.0;
};

void check_options(const RealTimeOptions& options) {
  const auto check = [](const char* name, double rate_hz) {
    if (!(rate_hz >= 1.0 && rate_hz <= 20'000.0)) {
      fail("real time: expected a rate of 1 to 20,000 Hz for ", name, ", found ", rate_hz, " Hz");
    }
  };
  check("collisions", options.rate_hz);
  check("the tool", options.tool_rate_hz);
  check("the display", options.display_rate_hz);
  if (options.output_rate_hz != 0.0) check("the output of forces", options.output_rate_hz);
  if (!(options.longest_s > 0.0)) fail("real time: expected a longest time above 0 s, found ", options.longest_s);
}

double period_ns(double rate_hz) { return 1e9 / rate_hz; }

/// What the threads do, and what passes between them.
class RealTimeRun {
 public:
  RealTimeRun(DrillSession& session, Operator& tool_operator, const RealTimeOptions& options,
              const CycleObserver& observe, const DisplayTask& display, const ForceTask& output)
      : session_(session),
        operator_(tool_operator),
        options_(options),
        observe_(observe),
        display_(display),
        output_(output),
        inputs_expected_(tool_operator.count()) {}

  RealTimeReport run(const Progress& progress);

 private:
  void put_tool();
  void run_tool(std::int64_t start_ns);
  bool ask_operator(std::uint64_t times);
  void put_bit();
  void run_collision(std::int64_t start_ns);
  void run_cycle(const TimedInput& latest, double clock_s);
  void run_display(std::int64_t start_ns);
  void run_output(std::int64_t start_ns);
  double share_done() const;

  DrillSession& session_;
  Operator& operator_;
  const RealTimeOptions& options_;
  const CycleObserver& observe_;
  const DisplayTask& display_;
  const ForceTask& output_;
  const std::size_t inputs_expected_;  ///< 0: not known

  LatestValue<TimedInput> inputs_;
  LatestValue<ToolFeedback> feedback_;
  LatestValue<Cycle> cycles_;
  LatestValue<TimedForce> forces_;
  std::atomic<bool> operator_ended_{false};
  std::atomic<bool> stops_{false};
  std::atomic<std::uint64_t> asked_{0};  ///< for progress
  std::atomic<double> clock_s_{0.0};     ///< likewise

  /// Of the collision thread alone: a step shares nothing out to ordinary threads, for which it would have to wait.
  tbb::task_arena alone_{1};
  TimedInput operator_at_;  ///< the tool thread's
  TimedInput bit_at_;       ///< the collision thread's
  RealTimeReport report_;
};

/// The operator's first pose, before the clock starts.
void RealTimeRun::put_tool() {
  if (const std::optional<ToolInput> first = operator_.next(session_.feedback())) {
    operator_at_.input = *first;
  } else {
    operator_ended_ = true;
  }
}

void RealTimeRun::run_tool(std::int64_t start_ns) {
  Pacer pacer(start_ns + std::llround(period_ns(options_.tool_rate_hz)), options_.tool_rate_hz);
  bool goes_on = !operator_ended_;
  while (!stops_ && goes_on) {
    const std::uint64_t due = pacer.wait();
    goes_on = ask_operator(due);
    pacer.finish(true);
  }
  report_.tool = pacer.report();
}

/// Passes on the last of the operator's next poses. False: the operator has ended.
bool RealTimeRun::ask_operator(std::uint64_t times) {
  feedback_.refresh();
  bool is_new = false;
  bool goes_on = true;
  for (std::uint64_t n = 0; n < times && goes_on; ++n) {
    if (const std::optional<ToolInput> next = operator_.next(feedback_.front())) {
      operator_at_ = {*next, operator_at_.index + 1, operator_at_.time_s + next->dt_s};
      is_new = true;
    } else {
      goes_on = false;
    }
  }
  if (is_new) inputs_.write(operator_at_);
  asked_.store(operator_at_.index, std::memory_order_relaxed);
  if (!goes_on) operator_ended_ = true;  // after the last input: whoever sees this finds that one too
  return goes_on;
}

/// The bit at the operator's first pose, which the engine takes longer for than for a cycle.
void RealTimeRun::put_bit() {
  if (!operator_ended_) run_cycle(operator_at_, 0.0);
}

void RealTimeRun::run_collision(std::int64_t start_ns) {
  // Half a period behind the operator's poses: at the same moment, chance would decide which one a cycle finds.
  Pacer pacer(start_ns + std::llround(period_ns(options_.tool_rate_hz) + 0.5 * period_ns(options_.rate_hz)),
              options_.rate_hz);
  for (bool is_over = operator_ended_; !stops_ && !is_over;) {
    pacer.wait();
    const double clock_s = 1e-9 * static_cast<double>(pacer.begin_ns() - start_ns);
    clock_s_.store(clock_s, std::memory_order_relaxed);
    is_over = operator_ended_ || clock_s >= options_.longest_s;
    const bool is_new = inputs_.refresh();
    if (is_new) run_cycle(inputs_.front(), clock_s);
    pacer.finish(is_new);
  }
  stops_ = true;
  report_.collision = pacer.report();
  report_.seconds = 1e-9 * static_cast<double>(wall_ns() - start_ns);
}

void RealTimeRun::run_cycle(const TimedInput& latest, double clock_s) {
  ToolInput input = latest.input;
  if (latest.index > bit_at_.index + 1) input.dt_s = latest.time_s - bit_at_.time_s;
  bit_at_ = latest;
  const Cycle& cycle = session_.step(input);
  feedback_.write(session_.feedback());
  if (options_.output_rate_hz > 0.0) forces_.write({cycle.force.force_n, clock_s});
  if (display_) cycles_.write(cycle);
  if (observe_) observe_(cycle);
}

void RealTimeRun::run_display(std::int64_t start_ns) {
  Pacer pacer(start_ns, options_.display_rate_hz);
  while (!stops_) {
    pacer.wait();
    const bool is_new = cycles_.refresh();
    if (is_new) display_(cycles_.front());
    pacer.finish(is_new);
  }
  report_.display = pacer.report();
}

void RealTimeRun::run_output(std::int64_t start_ns) {
  ForceOutput forces;
  Pacer pacer(start_ns, options_.output_rate_hz);
  while (!stops_) {
    pacer.wait();
    if (forces_.refresh()) forces.update(forces_.front().force_n, forces_.front().time_s);
    const Vec3 force_n = forces.at(1e-9 * static_cast<double>(pacer.begin_ns() - start_ns));
    if (output_) output_(force_n);
    pacer.finish(true);
  }
  report_.output = pacer.report();
}

double RealTimeRun::share_done() const {
  double share = clock_s_.load(std::memory_order_relaxed) / options_.longest_s;
  if (inputs_expected_ > 0) {
    share = std::max(
        share, static_cast<double>(asked_.load(std::memory_order_relaxed)) / static_cast<double>(inputs_expected_));
  }
  return std::min(share, 1.0);
}

RealTimeReport RealTimeRun::run(const Progress& progress) {
  std::vector<ThreadPart> parts{
      {kToolPriority, [this] { put_tool(); }, [this](std::int64_t start_ns) { run_tool(start_ns); }},
      {kCollisionPriority, [this] { alone_.execute([this] { put_bit(); }); },
       [this](std::int64_t start_ns) { alone_.execute([this, start_ns] { run_collision(start_ns); }); }}};
  if (display_) parts.push_back({kNoPriority, {}, [this](std::int64_t start_ns) { run_display(start_ns); }});
  if (options_.output_rate_hz > 0.0) {
    parts.push_back({kOutputPriority, {}, [this](std::int64_t start_ns) { run_output(start_ns); }});
  }
  TeamRights rights = run_together(parts, stops_, options_.wants_priority,
                                   [&] { progress.report("drilling in real time", share_done()); });
  report_.has_priority = rights.has_priority;
  report_.has_locked_memory = rights.has_locked_memory;
  session_.end(operator_.end());
  report_.warnings = std::move(rights.warnings);
  return std::move(report_);
}

}  // namespace

RealTimeReport run_real_time(DrillSession& session, Operator& tool_operator, const RealTimeOptions& options,
                             const CycleObserver& observe, const DisplayTask& display, const ForceTask& output,
                             const Progress& progress) {
  check_options(options);
  // On the heap: three of each value that passes between the threads are large for a stack.
  const auto run = std::make_unique<RealTimeRun>(session, tool_operator, options, observe, display, output);
  return run->run(progress);
}

}  // namespace spinaltap
