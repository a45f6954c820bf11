#pragma once

#include "core/session/operator/path_motion.h"
#include "core/session/operator/tool_source.h"

namespace spinaltap {

/// A hand that goes its planned way, whatever it feels: on the path, beside it or tilted, at given feeds, with pecks,
/// with a tremor. Ends at the motion's end, or when the session asks to stop.
class PathHand final : public ToolSource {
 public:
  PathHand(const DrillPath& path, const PathMotionOptions& options) : motion_(path, options) {}

  std::optional<ToolInput> next(const ToolFeedback& feedback) override {
    if (feedback.stop || index_ > motion_.cycle_count()) return std::nullopt;
    return ToolInput{motion_.pose(index_++), true, 1.0 / motion_.rate_hz()};
  }
  std::size_t count() const override { return motion_.cycle_count() + 1; }

 private:
  PathMotion motion_;
  std::size_t index_ = 0;
};

}  // namespace spinaltap
