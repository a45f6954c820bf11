#pragma once

#include <memory>

#include "core/session/operator/tool_source.h"
#include "core/study/study_task.h"

namespace spinaltap {

/// The hand that does a run: along the task's own line, from `lead_in_mm` before its entry. `spindle`: the session's.
std::unique_ptr<ToolSource> make_study_hand(const StudyTask& task, double lead_in_mm, const Spindle& spindle);

}  // namespace spinaltap
