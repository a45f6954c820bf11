#pragma once

#include <string>

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

}  // namespace spinaltap
