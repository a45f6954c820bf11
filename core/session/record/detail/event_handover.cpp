#include "core/session/record/detail/event_handover.h"

#include <algorithm>

#include "core/session/record/detail/record_columns.h"

namespace spinaltap {

EventHandover::EventHandover() : updates_(kRoom) { handed_.reserve(DrillSession::kMaxEvents); }

bool EventHandover::hand_over(std::span<const SessionEvent> events, bool looks_at_all) noexcept {
  constexpr std::size_t kLooks = 16;
  const std::size_t old = std::min(events.size(), handed_.size());
  const std::size_t looks = looks_at_all ? old : std::min(old, kLooks);
  for (std::size_t n = 0; n < looks; ++n) {
    const std::size_t index = looks_at_all ? n : next_look_++ % old;
    if (same_bits(event_columns(), events[index], handed_[index])) continue;
    if (!updates_.push({static_cast<std::uint32_t>(index), events[index]})) return false;
    handed_[index] = events[index];
  }
  const std::size_t max = std::min(events.size(), DrillSession::kMaxEvents);
  while (handed_.size() < max) {
    const std::size_t index = handed_.size();
    if (!updates_.push({static_cast<std::uint32_t>(index), events[index]})) return false;
    handed_.push_back(events[index]);
  }
  return true;
}

void EventHandover::lose(const Cycle& cycle) noexcept {
  if (!loses_) {
    loses_ = true;
    if (losses_ < kMaxLosses) {
      ++losses_;
      loss_ = {EventKind::record_lost, cycle.index, cycle.time_s, cycle.depth_mm, cycle.input.pose.tip_mm, 0.0};
    }
  }
  loss_.value += 1.0;
}

bool EventHandover::end_loss() noexcept {
  if (!loses_) return true;
  if (!updates_.push({kLosses + losses_ - 1, loss_})) return false;
  loses_ = false;
  return true;
}

}  // namespace spinaltap
