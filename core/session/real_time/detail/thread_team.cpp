#include "core/session/real_time/detail/thread_team.h"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <cstring>
#include <exception>
#include <fstream>
#include <latch>
#include <mutex>
#include <optional>
#include <thread>

#include "core/base/text_writer.h"
#include "core/session/real_time/timing.h"

namespace spinaltap {
namespace {

std::string limit_text(rlim_t limit, rlim_t unit) {
  return limit == RLIM_INFINITY ? "unlimited" : std::to_string(limit / unit);
}

std::string warning_of(const std::string& what, int error, const std::string& limit, const std::string& name) {
  return joined(what, " not allowed for this user (", limit, "; ", std::strerror(error),
                "): run as root, or give the user \"", name, "\" in /etc/security/limits.conf");
}

/// Of this program, as the kernel counts it; 0 where it does not say.
long locked_kb() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind("VmLck:", 0) == 0) return std::stol(line.substr(6));
  }
  return 0;
}

/// The first of what went wrong.
class Trouble {
 public:
  explicit Trouble(std::atomic<bool>& stops) : stops_(stops) {}

  template <class Task>
  void attempt(const Task& task) noexcept {
    try {
      task();
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!first_) first_ = std::current_exception();
      stops_ = true;
    }
  }
  void rethrow() const {
    if (first_) std::rethrow_exception(first_);
  }

 private:
  std::atomic<bool>& stops_;
  std::mutex mutex_;
  std::exception_ptr first_;
};

void ask_for_rights(const ThreadPart& part, bool wants_rights, TeamRights& rights) {
  if (part.priority == 0) return;
  ask_for_exact_sleeps();
  touch_stack();
  if (!wants_rights) return;
  const std::string warning = ask_for_priority(part.priority);
  if (warning.empty()) return;
  rights.has_priority = false;
  if (rights.warnings.empty()) rights.warnings.push_back(warning);  // once, though it is so for each thread
}

}  // namespace

std::string ask_for_priority(int priority) {
  const sched_param parameter{.sched_priority = priority};
  const int error = ::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &parameter);
  if (error == 0) return {};
  rlimit limit{};
  ::getrlimit(RLIMIT_RTPRIO, &limit);
  return warning_of("real-time priority", error, "ulimit -r is " + limit_text(limit.rlim_cur, 1), "rtprio 60");
}

void ask_for_exact_sleeps() noexcept { ::prctl(PR_SET_TIMERSLACK, 1UL, 0UL, 0UL, 0UL); }

void touch_stack() noexcept {
  constexpr std::size_t kPage = 4096;
  std::array<volatile unsigned char, 64 * kPage> stack;  // a step takes a few kB
  for (std::size_t at = 0; at < stack.size(); at += kPage) stack[at] = 0;
}

LockedMemory::LockedMemory() : was_locked_(locked_kb() > 0) {
  // On fault: what was never touched need not be brought in now.
  if (::mlockall(MCL_CURRENT | MCL_ONFAULT) == 0) {
    is_locked_ = true;
    return;
  }
  const int error = errno;
  rlimit limit{};
  ::getrlimit(RLIMIT_MEMLOCK, &limit);
  warning_ =
      warning_of("locked memory", error, "ulimit -l is " + limit_text(limit.rlim_cur, 1024), "memlock unlimited");
}

LockedMemory::~LockedMemory() {
  if (is_locked_ && !was_locked_) ::munlockall();
}

TeamRights run_together(std::span<const ThreadPart> parts, std::atomic<bool>& stops, bool wants_rights,
                        const std::function<void()>& watch) {
  TeamRights rights{.has_priority = wants_rights};
  Trouble trouble(stops);
  std::optional<LockedMemory> locked;
  std::atomic<std::size_t> ready{0};
  std::latch go(1);
  std::int64_t start_ns = 0;
  std::vector<std::jthread> threads;  // ended before what they use
  trouble.attempt([&] {
    for (const ThreadPart& part : parts) {
      threads.emplace_back([&, &part = part] {
        trouble.attempt([&] {
          ask_for_rights(part, wants_rights, rights);
          if (part.set_up && !stops) part.set_up();
        });
        ready.fetch_add(1);
        ready.notify_all();
        go.wait();
        if (!stops) trouble.attempt([&] { part.loop(start_ns); });
      });
      ready.wait(threads.size() - 1);
    }
    if (wants_rights) {
      locked.emplace();
      rights.has_locked_memory = locked->is_locked();
      if (!locked->warning().empty()) rights.warnings.push_back(locked->warning());
    }
    start_ns = wall_ns();
    go.count_down();
    while (!stops) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      watch();
    }
  });
  if (!go.try_wait()) go.count_down();
  threads.clear();
  trouble.rethrow();
  return rights;
}

}  // namespace spinaltap
