#pragma once

#include <limits>
#include <span>
#include <vector>

#include "core/session/session_event.h"

namespace spinaltap {

/// The events of a session, in the order in which they began. Has room for all that are kept from the start, so that
/// noting one allocates nothing; further ones are counted only.
class EventLog {
 public:
  static constexpr std::size_t kNotKept = std::numeric_limits<std::size_t>::max();

  explicit EventLog(std::size_t most) { events_.reserve(most); }

  /// Its index, or kNotKept.
  std::size_t add(const SessionEvent& event) noexcept {
    if (events_.size() == events_.capacity()) {
      ++lost_;
      return kNotKept;
    }
    events_.push_back(event);
    return events_.size() - 1;
  }
  /// Gives an event a larger value, and the place that goes with it.
  void raise(std::size_t index, double value, const Vec3& place_mm) noexcept {
    if (index >= events_.size() || !(value > events_[index].value)) return;
    events_[index].value = value;
    events_[index].place_mm = place_mm;
  }

  std::span<const SessionEvent> events() const { return events_; }
  std::size_t lost() const { return lost_; }

 private:
  std::vector<SessionEvent> events_;
  std::size_t lost_ = 0;
};

}  // namespace spinaltap
