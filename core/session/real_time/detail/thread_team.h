#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace spinaltap {

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
