#pragma once

#include <atomic>
#include <utility>

#include "core/base/error.h"

namespace spinaltap {

/// A thing that one thread at a time may use: long calls leave Python's lock, so another thread might come in.
template <class Thing>
class OneAtATime {
 public:
  explicit OneAtATime(Thing&& thing) : thing_(std::move(thing)) {}

  /// The right to use it, until it goes.
  class Turn {
   public:
    explicit Turn(OneAtATime& owner) : owner_(owner) {
      if (owner.is_busy_.test_and_set(std::memory_order_acquire)) {
        fail("expected one thread at a time, found it at work in another");
      }
    }
    ~Turn() { owner_.is_busy_.clear(std::memory_order_release); }
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;
    Thing* operator->() const { return &owner_.thing_; }

   private:
    OneAtATime& owner_;
  };
  /// Throws Error where another thread has it.
  Turn take() { return Turn(*this); }

 private:
  Thing thing_;
  std::atomic_flag is_busy_;
};

}  // namespace spinaltap
