#include "apps/link/link_loop.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <thread>

#include "apps/link/link_exchange.h"
#include "core/base/error.h"
#include "core/session/real_time/thread_rights.h"

namespace spinaltap {
namespace {

constexpr int kLoopPriority = 51;
constexpr double kHoldForceS = 0.020;
constexpr double kNoForceS = 0.050;

double seconds_between(std::int64_t from_ns, std::int64_t to_ns) { return 1e-9 * static_cast<double>(to_ns - from_ns); }

class LinkLoop {
 public:
  LinkLoop(Session& session, LinkServer& server, const LinkLoopOptions& options, const CycleObserver& observe)
      : session_(session),
        server_(server),
        options_(options),
        observe_(observe),
        receiver_{Tracking(options.tracking)},
        has_side_(session.path().bit.is_plate()) {}

  void run(const std::atomic<bool>& stops);
  const LinkLoopReport& report() const { return report_; }
  double seconds() const { return clock_s_.load(std::memory_order_relaxed); }

 private:
  void fetch();
  void run_cycle(const Pose& pose);
  void tell_cycle(const Cycle& cycle);
  void tell_events() { sender_.tell_events(session_, output_, server_); }
  void tell_state(std::int64_t now_ns);
  std::int64_t next_wake_ns(std::int64_t now_ns) const;

  Session& session_;
  LinkServer& server_;
  const LinkLoopOptions& options_;
  const CycleObserver& observe_;
  LinkReceiver receiver_;
  LinkSender sender_;
  bool has_side_;

  bool has_new_tool_ = false;
  LinkInput tool_;                    ///< the latest
  std::int64_t last_arrival_ns_ = 0;  ///< of the pose of the last cycle; 0: none yet
  std::int64_t last_cycle_ns_ = 0;
  bool is_fading_ = false;
  TrackingState told_ = TrackingState::waiting;
  LinkOutput output_;
  TimeHistogram steps_;
  LinkLoopReport report_;
  std::atomic<double> clock_s_{0.0};
};

/// What has come since the last time; of several poses of the tool the last.
void LinkLoop::fetch() {
  LinkInput input;
  while (server_.take(input)) {
    if (!receiver_.take(input)) continue;
    ++report_.poses;
    if (has_new_tool_) ++report_.merged;
    has_new_tool_ = true;
    tool_ = input;
  }
}

void LinkLoop::run(const std::atomic<bool>& stops) {
  if (options_.wants_priority) {
    ask_for_exact_sleeps();
    report_.has_priority = ask_for_priority(kLoopPriority).empty();
  }
  const std::int64_t start_ns = wall_ns();
  const auto min_period_ns = static_cast<std::int64_t>(0.5e9 / options_.rate_hz);
  while (!stops && !receiver_.is_ended) {
    std::int64_t now_ns = wall_ns();
    clock_s_.store(seconds_between(start_ns, now_ns), std::memory_order_relaxed);
    if (seconds_between(start_ns, now_ns) >= options_.longest_s) break;
    fetch();
    if (has_new_tool_ && now_ns - last_cycle_ns_ >= min_period_ns) {
      has_new_tool_ = false;
      if (std::optional<Pose> pose = receiver_.tracking.pose(now_ns)) {
        if (!has_side_) pose->side = Vec3::Zero();
        run_cycle(*pose);
      } else {
        ++report_.unseen;
      }
    }
    now_ns = wall_ns();
    tell_state(now_ns);
    if (!receiver_.is_ended) server_.wait(has_new_tool_ ? last_cycle_ns_ + min_period_ns : next_wake_ns(now_ns));
  }
  tell_events();
  report_.seconds = seconds_between(start_ns, wall_ns());
  report_.step_time = steps_.spread();
  report_.is_ended = receiver_.is_ended;
}

void LinkLoop::run_cycle(const Pose& pose) {
  constexpr double kShortestS = 1e-6, kLongestS = 3599.0;  // what a session takes as a time
  last_cycle_ns_ = wall_ns();
  const bool is_first = last_arrival_ns_ == 0;
  const double since_s = is_first ? 1.0 / options_.rate_hz : seconds_between(last_arrival_ns_, tool_.arrival_ns);
  const bool is_gap = is_first || since_s > options_.tracking.stale_s;
  if (is_gap && !is_first) ++report_.gaps;
  if (!is_first) report_.longest_gap_s = std::max(report_.longest_gap_s, since_s);
  last_arrival_ns_ = tool_.arrival_ns;
  const Cycle& cycle =
      session_.step_input({pose, receiver_.spindle_on && !is_gap, std::clamp(since_s, kShortestS, kLongestS)});
  ++report_.cycles;
  tell_cycle(cycle);
  if (observe_) observe_(cycle);
  tell_events();
  steps_.add(wall_ns() - last_cycle_ns_);
}

void LinkLoop::tell_cycle(const Cycle& cycle) {
  output_ = output_of(session_, cycle);
  output_.time_stamp = tool_.time_stamp;
  output_.arrival_ns = tool_.arrival_ns;
  told_ = TrackingState::ok;
  is_fading_ = true;  // from when the next pose does not come
  sender_.tell_stop(session_, output_, server_);
  server_.give(output_);
}

/// Where no pose comes: that it is so, and forces that fade.
void LinkLoop::tell_state(std::int64_t now_ns) {
  const TrackingState tracking = receiver_.tracking.state(now_ns);
  const double silent_s = seconds_between(last_arrival_ns_, now_ns);
  const bool fades = is_fading_ && silent_s > kHoldForceS;
  if (tracking == told_ && !fades) return;
  LinkOutput state = output_;
  state.kind = LinkOutput::Kind::state;
  state.tracking = tracking;
  const double share = last_arrival_ns_ == 0 ? 0.0 : force_share(silent_s);
  state.force_n = share * output_.force_n;
  state.thrust_n = share * output_.thrust_n;
  state.torque_n_mm = share * output_.torque_n_mm;
  if (fades && share == 0.0) {
    is_fading_ = false;
    ++report_.silences;
    output_.force_n = Vec3::Zero();
    output_.thrust_n = 0.0;
    output_.torque_n_mm = 0.0;
  }
  told_ = tracking;
  server_.give(state);
}

std::int64_t LinkLoop::next_wake_ns(std::int64_t now_ns) const {
  constexpr std::int64_t kFadeNs = 2'000'000, kIdleNs = 20'000'000;
  if (!is_fading_) return now_ns + kIdleNs;
  return std::max(now_ns + kFadeNs, last_arrival_ns_ + static_cast<std::int64_t>(1e9 * kHoldForceS) + kFadeNs);
}

}  // namespace

double force_share(double silent_s) { return std::clamp((kNoForceS - silent_s) / (kNoForceS - kHoldForceS), 0.0, 1.0); }

LinkLoopReport run_link(Session& session, LinkServer& server, const LinkLoopOptions& options,
                        const CycleObserver& observe, const Progress& progress) {
  if (!(options.rate_hz >= 1.0 && options.rate_hz <= 20'000.0)) {
    fail("link: expected a rate of 1 to 20,000 Hz, found ", options.rate_hz, " Hz");
  }
  if (!(options.longest_s > 0.0)) fail("link: expected a longest time above 0 s, found ", options.longest_s);
  if (!(options.tracking.stale_s > 0.0)) {
    fail("link: expected a time above 0 s until a pose is stale, found ", options.tracking.stale_s, " s");
  }
  LinkLoop loop(session, server, options, observe);
  std::atomic<bool> stops{false}, is_over{false};
  std::exception_ptr trouble;
  std::thread thread([&] {
    try {
      // A step shares nothing out to ordinary threads, for which it would have to wait.
      tbb::task_arena alone(1);
      alone.execute([&] { loop.run(stops); });
    } catch (...) {
      trouble = std::current_exception();
    }
    is_over = true;
  });
  try {
    while (!is_over) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      progress.report("linked session", std::min(0.999, loop.seconds() / options.longest_s));
    }
  } catch (const Cancelled&) {
    // Whoever ends a session from outside wants what it has done until then.
  } catch (...) {
    trouble = std::current_exception();
  }
  stops = true;
  thread.join();
  if (trouble) std::rethrow_exception(trouble);
  return loop.report();
}

}  // namespace spinaltap
