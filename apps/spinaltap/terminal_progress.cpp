#include "apps/spinaltap/terminal_progress.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <string>

#include "core/base/text_writer.h"

namespace spinaltap {
namespace {

using Clock = std::chrono::steady_clock;

/// Draws the bar. Calls do not overlap (see Progress).
class Bar {
 public:
  void show(std::string_view stage, double fraction) {
    const Clock::time_point now = Clock::now();
    // What follows a colon tells how the stage goes on, and changes.
    const std::string_view name = stage.substr(0, stage.find(':'));
    if (name != stage_) {
      clear();
      stage_ = name;
      started_ = now;
    }
    if (fraction >= 1.0) {
      clear();
      return;
    }
    const bool slow = now - started_ > std::chrono::seconds(1);
    if (!slow || (drawn_ && now - drawn_at_ < std::chrono::milliseconds(100))) return;
    constexpr int kWidth = 30;
    const int filled = static_cast<int>(kWidth * std::clamp(fraction, 0.0, 1.0));
    std::fprintf(stderr, "\r%-34s [%s%s] %3s %%", std::string(stage).c_str(),
                 std::string(static_cast<std::size_t>(filled), '#').c_str(),
                 std::string(static_cast<std::size_t>(kWidth - filled), '.').c_str(),
                 fixed_text(100.0 * fraction, 0).c_str());
    std::fflush(stderr);
    drawn_ = true;
    drawn_at_ = now;
  }

 private:
  void clear() {
    if (drawn_) std::fprintf(stderr, "\r%76s\r", "");
    drawn_ = false;
  }

  std::string stage_;  ///< its name
  Clock::time_point started_;
  Clock::time_point drawn_at_;
  bool drawn_ = false;
};

/// What the signal handler cancels; set once, before the handler is.
Progress& shared_progress() {
  static Progress progress;
  return progress;
}

extern "C" void cancel_on_signal(int) { shared_progress().cancel(); }

volatile std::sig_atomic_t told_to_leave = 0;

extern "C" void note_signal(int signal) {
  if (told_to_leave == 0) told_to_leave = signal;
}

}  // namespace

Progress terminal_progress() {
  Progress::Callback callback;
  if (::isatty(STDERR_FILENO) == 1) {
    callback = [bar = Bar()](std::string_view stage, double fraction) mutable { bar.show(stage, fraction); };
  }
  shared_progress() = Progress(std::move(callback));
  struct sigaction action {};
  action.sa_handler = cancel_on_signal;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  ::sigaction(SIGINT, &action, nullptr);
  ::sigaction(SIGTERM, &action, nullptr);
  // A write beyond a file size limit is to fail like one on a full disk, not to kill the program.
  ::signal(SIGXFSZ, SIG_IGN);
  return shared_progress();
}

void leave_on_signals() {
  struct sigaction action {};
  action.sa_handler = note_signal;
  action.sa_flags = SA_RESTART;
  ::sigaction(SIGTERM, &action, nullptr);
  ::sigaction(SIGUSR1, &action, nullptr);
}

const char* leave_signal() {
  if (told_to_leave == 0) return nullptr;
  return told_to_leave == SIGTERM ? "SIGTERM" : "SIGUSR1";
}

}  // namespace spinaltap
