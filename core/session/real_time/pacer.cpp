#include "core/session/real_time/pacer.h"

#include <cerrno>
#include <cmath>
#include <ctime>

#include "core/session/real_time/timing.h"

namespace spinaltap {
namespace {

/// wall_ns() is std::chrono::steady_clock, which on Linux is CLOCK_MONOTONIC.
void sleep_until(std::int64_t time_ns) noexcept {
  constexpr std::int64_t kSecond = 1'000'000'000;
  const std::timespec time{.tv_sec = time_ns / kSecond, .tv_nsec = time_ns % kSecond};
  while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &time, nullptr) == EINTR) {
  }
}

}  // namespace

Pacer::Pacer(std::int64_t start_ns, double rate_hz)
    : start_ns_(start_ns), rate_hz_(rate_hz), begin_ns_(start_ns), end_ns_(start_ns) {}

std::int64_t Pacer::due_ns(std::uint64_t index) const {
  return start_ns_ + std::llround(static_cast<double>(index) * 1e9 / rate_hz_);
}

std::uint64_t Pacer::wait() noexcept {
  const std::int64_t asked_ns = due_ns(next_);
  sleep_until(asked_ns);
  begin_ns_ = wall_ns();
  begin_cpu_ns_ = thread_cpu_ns();
  wake_up_.add(begin_ns_ - asked_ns);
  std::uint64_t due = 1;
  while (due_ns(next_ + due) <= begin_ns_) ++due;
  skipped_ += due - 1;
  next_ += due;
  return due;
}

void Pacer::finish(bool worked) noexcept {
  const std::int64_t cpu_ns = thread_cpu_ns() - begin_cpu_ns_;
  end_ns_ = wall_ns();
  if (!worked) {
    ++idle_;
    return;
  }
  ++cycles_;
  work_wall_.add(end_ns_ - begin_ns_);
  work_cpu_.add(cpu_ns);
  if (end_ns_ > due_ns(next_)) ++missed_;
}

PaceReport Pacer::report() const {
  PaceReport report;
  const double seconds = 1e-9 * static_cast<double>(end_ns_ - start_ns_);
  report.rate_hz = seconds > 0.0 ? static_cast<double>(cycles_) / seconds : 0.0;
  report.cycles = cycles_;
  report.idle = idle_;
  report.missed = missed_;
  report.skipped = skipped_;
  report.wake_up = wake_up_.spread();
  report.work_wall = work_wall_.spread();
  report.work_cpu = work_cpu_.spread();
  report.wake_up_histogram = wake_up_.octaves();
  report.work_histogram = work_wall_.octaves();
  return report;
}

}  // namespace spinaltap
