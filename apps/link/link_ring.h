#pragma once

#include <atomic>
#include <cstddef>

#include "core/base/ring_buffer.h"

namespace spinaltap {

/// A ring buffer that takes one value at a time and counts. Where the reader is so far behind that there is no room,
/// the newest is not taken, and counts as lost.
template <class Value>
class LinkRing {
 public:
  explicit LinkRing(std::size_t room) : values_(room) {}

  bool give(const Value& value) noexcept {
    if (values_.push(value)) return true;
    lost_.fetch_add(1, std::memory_order_relaxed);
    return false;
  }
  bool take(Value& value) noexcept {
    return values_.pop(1, [&value](const Value& oldest) { value = oldest; }) == 1;
  }
  std::size_t lost() const noexcept { return lost_.load(std::memory_order_relaxed); }

 private:
  RingBuffer<Value> values_;
  std::atomic<std::size_t> lost_{0};
};

}  // namespace spinaltap
