#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace spinaltap {

/// Hands the latest value from one thread to another without locks: a triple buffer. One thread writes, one reads;
/// neither ever waits, and the reader never sees half a value.
template <typename T>
class LatestValue {
 public:
  /// Writing thread: fill this, then publish().
  T& back() noexcept { return slots_[back_]; }
  void publish() noexcept { back_ = middle_.exchange(static_cast<std::uint8_t>(back_ | kFresh)) & kSlot; }
  void write(const T& value) noexcept {
    back() = value;
    publish();
  }

  /// Reading thread: takes the latest value, if there is a newer one than last time.
  bool refresh() noexcept {
    if ((middle_.load(std::memory_order_relaxed) & kFresh) == 0) return false;
    front_ = middle_.exchange(front_) & kSlot;
    return true;
  }
  const T& front() const noexcept { return slots_[front_]; }

 private:
  static constexpr std::uint8_t kFresh = 4;
  static constexpr std::uint8_t kSlot = 3;

  std::array<T, 3> slots_{};
  alignas(64) std::uint8_t back_ = 0;   ///< of the writing thread
  alignas(64) std::uint8_t front_ = 1;  ///< of the reading thread
  alignas(64) std::atomic<std::uint8_t> middle_{2};
};

}  // namespace spinaltap
