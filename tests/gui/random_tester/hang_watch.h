#pragma once

#include <QElapsedTimer>
#include <QTimer>
#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <string>
#include <thread>
#include <utility>

#include <execinfo.h>
#include <pthread.h>
#include <unistd.h>

namespace spinaltap::test {

/// Watches that the window's thread comes back to its events: the longest time that it did not. Time for which the
/// system had no core for that thread, because others were busy, does not count. Where it stays away for a second, a
/// thread of its own notes where it is.
class HangWatch {
 public:
  struct Standstill {
    double longest_s = 0.0;
    double worked_s = 0.0;  ///< of that, on a core: the rest it waited for something, or the machine stood still
    std::string where;      ///< modules and places in them, for addr2line; empty below a second
  };

  HangWatch() : thread_(::pthread_self()), thread_id_(std::to_string(::gettid())) {
    constexpr int kBeatMs = 20;
    QObject::connect(&beat_, &QTimer::timeout, &beat_, [this] { end_wait(); });
    beat_.start(kBeatMs);
    last_times_ = times();
    struct sigaction action {};
    action.sa_handler = [](int) { count_ = ::backtrace(frames_.data(), static_cast<int>(frames_.size())); };
    action.sa_flags = SA_RESTART;
    ::sigaction(kSignal, &action, nullptr);
    (void)::backtrace(frames_.data(), 1);  // loads what it needs, which a handler may not
    watcher_ = std::jthread([this](const std::stop_token& stop) { watch(stop); });
  }

  /// Since the last call.
  Standstill take_longest() {
    end_wait();
    return std::exchange(longest_, {});
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr int kSignal = SIGUSR2;

  /// Linux keeps count of what a thread ran, and of what it waited for a core; elsewhere both are 0.
  struct Times {
    double ran_s = 0.0, waited_s = 0.0;
  };
  Times times() const {
    std::ifstream file("/proc/self/task/" + thread_id_ + "/schedstat");
    Times ns;
    file >> ns.ran_s >> ns.waited_s;
    return {1e-9 * ns.ran_s, 1e-9 * ns.waited_s};
  }

  void end_wait() {
    const Clock::time_point now = Clock::now();
    const Times current = times();
    const double passed_s =
        std::chrono::duration<double>(now - last_).count() - (current.waited_s - last_times_.waited_s);
    const int frames = count_.exchange(0);
    if (passed_s > longest_.longest_s) {
      longest_ = {passed_s, current.ran_s - last_times_.ran_s, frames > 0 ? words_of(frames) : ""};
    }
    last_ = now;
    last_times_ = current;
    ++beats_;
  }

  void watch(const std::stop_token& stop) {
    std::size_t seen = 0;
    int checks = 0;
    while (!stop.stop_requested()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
      checks = std::exchange(seen, beats_.load()) == beats_ ? checks + 1 : 0;
      if (checks == 10) ::pthread_kill(thread_, kSignal);
    }
  }

  static std::string words_of(int frames) {
    char** const names = ::backtrace_symbols(frames_.data(), frames);
    std::string words;
    for (int n = 0; names != nullptr && n < frames; ++n) words += std::string("\n    ") + names[n];
    std::free(names);
    return words;
  }

  // Of the handler.
  static inline std::array<void*, 64> frames_{};
  static inline std::atomic<int> count_{0};

  pthread_t thread_;
  std::string thread_id_;
  QTimer beat_;
  std::atomic<std::size_t> beats_{0};
  Clock::time_point last_ = Clock::now();
  Times last_times_;
  Standstill longest_;
  std::jthread watcher_;  // last: it ends first
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
