#include "core/study/study_hand.h"

#include "core/session/operator/path_hand.h"
#include "core/session/operator/push_hand.h"

namespace spinaltap {

std::unique_ptr<ToolSource> make_study_hand(const StudyTask& task, double lead_in_mm, const Spindle& spindle) {
  const GuideLine line{.lead_in_mm = lead_in_mm};
  if (task.hand.kind == StudyHand::Kind::push) {
    PushOptions options;
    options.line = line;
    options.rate_hz = task.hand.rate_hz;
    options.spindle = spindle;
    options.push_n = task.hand.push_n;
    options.reaction_s = task.hand.reaction_s;
    options.noticed_share = task.hand.noticed_share;
    options.tremor_mm = task.hand.tremor_mm;
    options.seed = task.seed;
    return std::make_unique<PushHand>(task.path, options);
  }
  PathMotionOptions options;
  options.line = line;
  options.rate_hz = task.hand.feed_mm_s / task.hand.step_mm;
  options.feed.steps = {{0.0, task.hand.feed_mm_s}};
  options.tremor_mm = task.hand.tremor_mm;
  options.seed = task.seed;
  return std::make_unique<PathHand>(task.path, options);
}

}  // namespace spinaltap
