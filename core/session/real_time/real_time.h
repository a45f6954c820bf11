#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/session/cycle.h"
#include "core/session/operator/operator.h"
#include "core/session/real_time/timing.h"

namespace spinaltap {

class DrillSession;

/// How often the threads run, for how long, and with what rights.
struct RealTimeOptions {
  double rate_hz = 1000.0;        ///< of the collision thread
  double tool_rate_hz = 1000.0;   ///< of the thread that asks the operator
  double display_rate_hz = 60.0;  ///< of the thread that draws; it takes what time it takes
  double output_rate_hz = 0.0;    ///< of forces extrapolated for a device, 5,000 to 10,000; 0: none
  double longest_s = 600.0;       ///< ends then, at the latest
  bool wants_priority = false;    ///< SCHED_FIFO and locked memory, where the user's rights allow
};

/// Times of one of the threads' cycles. Every due time is a cycle, idle or skipped. Percentiles are to 1 %, what is
/// greatest exact; wake-ups are those of cycles and idle ones.
struct PaceReport {
  double rate_hz = 0.0;       ///< reached
  std::uint64_t cycles = 0;   ///< that had something to do
  std::uint64_t idle = 0;     ///< due times at which there was nothing new to do
  std::uint64_t missed = 0;   ///< cycles whose work ended after the next was due
  std::uint64_t skipped = 0;  ///< due times that passed without a cycle of their own
  TimeSpread wake_up;         ///< from when a cycle was due to when it began
  TimeSpread work_wall;       ///< of the cycle's work
  TimeSpread work_cpu;
  std::vector<std::uint64_t> wake_up_histogram;  ///< counts; bin n: 2^n to 2^(n+1) µs, the first from 0
  std::vector<std::uint64_t> work_histogram;
};

/// What a run came to.
struct RealTimeReport {
  PaceReport collision, tool, display;
  PaceReport output;  ///< cycles 0 where none was asked for
  double seconds = 0.0;
  bool has_priority = false;  ///< ran as SCHED_FIFO
  bool has_locked_memory = false;
  std::vector<std::string> warnings;  ///< what the user's rights did not allow, in words
};

/// What the display thread is called with: the session's latest cycle, seldom every one.
using DisplayTask = std::function<void(const Cycle&)>;
/// What a haptic device is called with at output_rate_hz.
using ForceTask = std::function<void(const Vec3& force_n)>;

/// The paper's section 9.2: tool, collision and display as three threads, which pass their latest values without locks.
/// Each is paced by absolute times of the monotonic clock; what came too late is counted and not made up for.
///
/// The operator is asked on the tool thread. Its time goes on with the clock: where the tool thread comes late, it asks
/// for every pose that has come due and passes on the last. The first pose, where the bit is put, is taken before the
/// clock starts. The collision thread takes the operator's latest pose: of several new ones the last, with the time of
/// all of them as its dt, and the bit cuts the straight way there; without a new one it does nothing, and forces stay.
/// `observe` is called on it and must not wait; its time counts as the cycle's. Inputs that it sees, put through
/// run_session(), bring the same results.
///
/// Ends when the operator does, or after longest_s. Throws Error on rates out of range (1 to 20,000 Hz), what
/// `tool_operator`, `observe` and the tasks throw, and Cancelled where `progress` is cancelled; all threads have ended
/// then.
RealTimeReport run_real_time(DrillSession& session, Operator& tool_operator, const RealTimeOptions& options,
                             const CycleObserver& observe = {}, const DisplayTask& display = {},
                             const ForceTask& output = {}, const Progress& progress = {});

}  // namespace spinaltap
