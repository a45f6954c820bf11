#include "core/session/real_time/detail/thread_team.h"

#include <chrono>
#include <cstddef>
#include <exception>
#include <latch>
#include <mutex>
#include <optional>
#include <thread>

#include "core/session/real_time/thread_rights.h"
#include "core/session/real_time/timing.h"

namespace spinaltap {
namespace {

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
