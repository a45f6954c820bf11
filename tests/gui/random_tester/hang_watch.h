#pragma once

#include <QElapsedTimer>
#include <QTimer>
#include <atomic>
#include <chrono>
#include <fstream>
#include <string>
#include <thread>

#include <unistd.h>

namespace spinaltap::test {

/// Watches, from a thread of its own, that the window's thread comes back to its events: the longest time that it did
/// not. Time for which the system had no core for that thread, because others were busy, does not count.
class HangWatch {
 public:
  HangWatch() : thread_id_(std::to_string(::gettid())) {
    constexpr int kBeatMs = 20;
    QObject::connect(&beat_, &QTimer::timeout, &beat_, [this] { end_wait(); });
    beat_.start(kBeatMs);
    last_waited_s_ = waited_for_core_s();
  }

  /// Since the last call, s.
  double take_longest_s() {
    end_wait();
    return std::exchange(longest_s_, 0.0);
  }

 private:
  using Clock = std::chrono::steady_clock;

  void end_wait() {
    const Clock::time_point now = Clock::now();
    const double waited_s = waited_for_core_s();
    const double passed_s = std::chrono::duration<double>(now - last_).count() - (waited_s - last_waited_s_);
    longest_s_ = std::max(longest_s_, passed_s);
    last_ = now;
    last_waited_s_ = waited_s;
  }
  /// Linux keeps count of it; elsewhere it is 0.
  double waited_for_core_s() const {
    std::ifstream file("/proc/self/task/" + thread_id_ + "/schedstat");
    double running_ns = 0.0, waiting_ns = 0.0;
    file >> running_ns >> waiting_ns;
    return 1e-9 * waiting_ns;
  }

  std::string thread_id_;
  QTimer beat_;
  Clock::time_point last_ = Clock::now();
  double last_waited_s_ = 0.0;
  double longest_s_ = 0.0;
};

/// Ends the process, with a word on what it was at, where the window's thread does not come back at all.
class DeadlockGuard {
 public:
  DeadlockGuard(int max_s, std::function<void()> tell) : max_s_(max_s), tell_(std::move(tell)) {
    QObject::connect(&beat_, &QTimer::timeout, &beat_, [this] { beats_ = 0; });
    beat_.start(100);
    thread_ = std::jthread([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        std::this_thread::sleep_for(std::chrono::milliseconds(500));
        if (++beats_ < 2 * max_s_) continue;
        tell_();
        ::abort();  // a core file, or a sanitizer's stack, tells where it stands
      }
    });
  }

 private:
  int max_s_;
  std::function<void()> tell_;
  QTimer beat_;
  std::atomic<int> beats_{0};
  std::jthread thread_;
};

}  // namespace spinaltap::test
