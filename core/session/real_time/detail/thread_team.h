#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace spinaltap {

/// Makes the calling thread a SCHED_FIFO thread: it runs before all ordinary ones. `priority`: 1 to 99. Empty where
/// that was done, else a warning in words on what the user's rights lack.
std::string ask_for_priority(int priority);

/// Lets the calling thread's sleeps end when they should: by default Linux puts off the wake-ups of ordinary threads by
/// up to 50 µs. Takes no rights.
void ask_for_exact_sleeps() noexcept;

/// Touches the calling thread's stack, so that no page of it is missing later.
void touch_stack() noexcept;

/// Keeps what the program now has in memory there, for as long as this lives. What is allocated later is not kept, so
/// that no allocation can fail for want of rights. Memory that others had locked before stays locked.
class LockedMemory {
 public:
  LockedMemory();
  ~LockedMemory();
  LockedMemory(const LockedMemory&) = delete;
  LockedMemory& operator=(const LockedMemory&) = delete;

  bool is_locked() const { return is_locked_; }
  /// In words, where the user's rights do not allow it; else empty.
  const std::string& warning() const { return warning_; }

 private:
  bool is_locked_ = false;
  bool was_locked_ = false;  ///< by others, before
  std::string warning_;
};

/// One thread of a team.
struct ThreadPart {
  int priority = 0;                                 ///< of SCHED_FIFO; 0: an ordinary thread
  std::function<void()> set_up;                     ///< before the clock starts; may be empty
  std::function<void(std::int64_t start_ns)> loop;  ///< from the clock's start, as wall_ns() has it
};

struct TeamRights {
  bool has_priority = false;  ///< every thread that was to have one
  bool has_locked_memory = false;
  std::vector<std::string> warnings = {};  ///< what the user's rights did not allow, in words
};

/// Runs threads together: they are made and set up one after the other, then the clock starts for all at once. Returns
/// when all loops have; they must return soon once `stops` is set. The calling thread calls `watch` every 10 ms until
/// then. What any of them throws sets `stops` and is thrown here, the first of it, when all threads have ended.
/// `wants_rights`: priorities and locked memory, where the user's rights allow; given back at the end.
TeamRights run_together(std::span<const ThreadPart> parts, std::atomic<bool>& stops, bool wants_rights,
                        const std::function<void()>& watch);

}  // namespace spinaltap
