#pragma once

#include <atomic>
#include <cstddef>
#include <vector>

namespace spinaltap {

/// Passes values from one thread to another, in order, without locks; memory is there from the start. Where the reader
/// is so far behind that there is no room, the newest is not taken, and counts as lost.
template <class Value>
class LinkRing {
 public:
  explicit LinkRing(std::size_t room) : values_(room + 1) {}

  bool give(const Value& value) noexcept {
    const std::size_t end = end_.load(std::memory_order_relaxed);
    const std::size_t next = (end + 1) % values_.size();
    if (next == begin_.load(std::memory_order_acquire)) {
      lost_.fetch_add(1, std::memory_order_relaxed);
      return false;
    }
    values_[end] = value;
    end_.store(next, std::memory_order_release);
    return true;
  }
  bool take(Value& value) noexcept {
    const std::size_t begin = begin_.load(std::memory_order_relaxed);
    if (begin == end_.load(std::memory_order_acquire)) return false;
    value = values_[begin];
    begin_.store((begin + 1) % values_.size(), std::memory_order_release);
    return true;
  }
  std::size_t lost() const noexcept { return lost_.load(std::memory_order_relaxed); }

 private:
  std::vector<Value> values_;
  alignas(64) std::atomic<std::size_t> begin_{0};
  alignas(64) std::atomic<std::size_t> end_{0};
  std::atomic<std::size_t> lost_{0};
};

}  // namespace spinaltap
