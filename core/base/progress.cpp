#include "core/base/progress.h"

#include <algorithm>
#include <mutex>

#include "core/base/error.h"

namespace spinaltap {

struct Progress::State {
  Callback callback;
  std::mutex callback_mutex;
  std::atomic<bool> cancelled{false};
};

Progress::Progress(Callback callback) : state_(std::make_shared<State>()) { state_->callback = std::move(callback); }

void Progress::report(std::string_view stage, double fraction) const {
  if (!state_) return;
  if (state_->cancelled.load(std::memory_order_relaxed)) throw Cancelled();
  if (!state_->callback) return;
  const std::lock_guard lock(state_->callback_mutex);
  state_->callback(stage, fraction);
}

void Progress::cancel() const {
  if (state_) state_->cancelled.store(true, std::memory_order_relaxed);
}

ProgressCounter::ProgressCounter(const Progress& progress, std::string_view stage, std::size_t total)
    : progress_(progress), stage_(stage), total_(std::max<std::size_t>(total, 1)) {
  progress_.report(stage_, 0.0);
}

void ProgressCounter::add(std::size_t pieces) {
  const std::size_t before = done_.fetch_add(pieces, std::memory_order_relaxed);
  const std::size_t after = before + pieces;
  if (before * 100 / total_ != after * 100 / total_) {
    progress_.report(stage_, static_cast<double>(after) / static_cast<double>(total_));
  }
}

}  // namespace spinaltap
