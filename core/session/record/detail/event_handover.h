#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/ring_buffer.h"
#include "core/session/cycle.h"
#include "core/session/drill_session.h"

namespace spinaltap {

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
