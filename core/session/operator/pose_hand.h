#pragma once

#include <vector>

#include "core/session/operator/tool_source.h"

namespace spinaltap {

/// A hand whose poses are known beforehand: from a file, a record or a test.
class PoseHand final : public ToolSource {
 public:
  /// `heeds_stop`: ends when the session asks to stop.
  explicit PoseHand(std::vector<ToolInput> inputs, bool heeds_stop = true)
      : inputs_(std::move(inputs)), heeds_stop_(heeds_stop) {}

  std::optional<ToolInput> next(const ToolFeedback& feedback) override {
    if ((heeds_stop_ && feedback.stop) || index_ == inputs_.size()) return std::nullopt;
    return inputs_[index_++];
  }
  std::size_t count() const override { return inputs_.size(); }

 private:
  std::vector<ToolInput> inputs_;
  bool heeds_stop_;
  std::size_t index_ = 0;
};

}  // namespace spinaltap
