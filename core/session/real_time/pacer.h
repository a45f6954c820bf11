#pragma once

#include <cstdint>

#include "core/session/real_time/real_time.h"
#include "core/session/real_time/timing.h"

namespace spinaltap {

/// Paces one thread by absolute times of the monotonic clock, and measures it. Cycle n is due n periods after the
/// start, computed from n alone, so that no error adds up. What came too late is not made up for: a thread that wakes
/// when further cycles have come due does one cycle for all of them, and the others count as skipped.
class Pacer {
 public:
  /// `start_ns` as wall_ns() has it.
  Pacer(std::int64_t start_ns, double rate_hz);

  /// Sleeps until the next cycle is due and begins it. How many cycles have come due since the last: 1 where the thread
  /// is in time.
  std::uint64_t wait() noexcept;
  /// Ends the cycle. `worked`: it had something to do.
  void finish(bool worked) noexcept;

  /// When the present cycle began, ns.
  std::int64_t begin_ns() const { return begin_ns_; }
  PaceReport report() const;

 private:
  std::int64_t due_ns(std::uint64_t index) const;

  std::int64_t start_ns_;
  double rate_hz_;
  std::uint64_t next_ = 0;  ///< due
  std::int64_t begin_ns_;
  std::int64_t begin_cpu_ns_ = 0;
  std::int64_t end_ns_;
  std::uint64_t cycles_ = 0;
  std::uint64_t idle_ = 0;
  std::uint64_t missed_ = 0;
  std::uint64_t skipped_ = 0;
  TimeHistogram wake_up_;
  TimeHistogram work_wall_;
  TimeHistogram work_cpu_;
};

}  // namespace spinaltap
