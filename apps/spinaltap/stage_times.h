#pragma once

#include "core/base/stage_clock.h"
#include "core/files/json_file.h"

namespace spinaltap {

/// Prints how long the stages took and the most memory that the program had, all on one line, and gives it as JSON:
/// `stages` and `total`, each with `wall_s` and `processor_s`, and `most_memory_bytes`.
Json report_times(const StageClock& clock);

}  // namespace spinaltap
