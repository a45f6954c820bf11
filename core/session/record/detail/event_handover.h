#pragma once

#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/session/drill_session.h"
#include "core/session/session_event.h"

namespace spinaltap {

/// Operators values from one thread to one other, in order, without locks: room for a number of them that is allocated,
/// and touched, at the start. Neither thread ever waits.
template <typename T>
class RingBuffer {
 public:
  /// `room` is rounded up to a power of two.
  explicit RingBuffer(std::size_t room) : slots_(std::bit_ceil(room)), mask_(slots_.size() - 1) {}

  /// Writing thread. False, and nothing done, where there is no room.
  bool push(const T& value) noexcept {
    const std::uint64_t end = end_.load(std::memory_order_relaxed);
    if (end - begin_.load(std::memory_order_acquire) >= slots_.size()) return false;
    slots_[end & mask_] = value;
    end_.store(end + 1, std::memory_order_release);
    return true;
  }
  /// How many have been pushed, from the start. From any thread.
  std::uint64_t pushed() const noexcept { return end_.load(std::memory_order_acquire); }

  /// Reading thread: gives `take` up to `max` values, in order; how many there were.
  template <class Take>
  std::size_t pop(std::size_t max, const Take& take) {
    const std::uint64_t begin = begin_.load(std::memory_order_relaxed);
    std::size_t count = static_cast<std::size_t>(end_.load(std::memory_order_acquire) - begin);
    if (count > max) count = max;
    for (std::size_t n = 0; n < count; ++n) take(slots_[(begin + n) & mask_]);
    begin_.store(begin + count, std::memory_order_release);
    return count;
  }

 private:
  std::vector<T> slots_;
  std::size_t mask_;
  alignas(64) std::atomic<std::uint64_t> end_{0};    ///< of the writing thread
  alignas(64) std::atomic<std::uint64_t> begin_{0};  ///< of the reading thread
};

/// A session's events on their way from the thread that makes them to the one that writes them: what is new and what
/// has changed, without locks. Cycles that the record lost are events of its own.
class EventHandover {
 public:
  /// The same `slot` again is the same event, changed.
  struct Update {
    std::uint32_t slot = 0;
    SessionEvent event;
  };

  EventHandover();

  /// Session's thread: hands over new events and changed ones. Old ones are looked at in turns, so that a call takes
  /// about a microsecond however many there are. False where some are still to come.
  bool hand_over(std::span<const SessionEvent> events, bool looks_at_all = false) noexcept;
  /// Session's thread: the cycle was lost.
  void lose(const Cycle& cycle) noexcept;
  /// Session's thread: a cycle got through, so that a later loss is another event. False where the event is still to
  /// come.
  bool end_loss() noexcept;

  /// Writing thread.
  template <class Take>
  std::size_t take(const Take& take) {
    return updates_.pop(kRoom, take);
  }

 private:
  static constexpr std::size_t kRoom = 8192;
  /// Losses have slots from here on; after so many, all further ones are one.
  static constexpr std::uint32_t kLosses = DrillSession::kMaxEvents;
  static constexpr std::uint32_t kMaxLosses = 1024;

  RingBuffer<Update> updates_;
  std::vector<SessionEvent> handed_;  ///< of the session's, as they were handed over
  std::size_t next_look_ = 0;
  SessionEvent loss_;
  std::uint32_t losses_ = 0;
  bool loses_ = false;
};

}  // namespace spinaltap
