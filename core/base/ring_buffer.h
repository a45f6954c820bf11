#pragma once

#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace spinaltap {

/// Hands values from one thread to one other, in order, without locks: room for a number of them that is allocated,
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

}  // namespace spinaltap
