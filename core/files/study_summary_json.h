#pragma once

#include "core/files/json_file.h"
#include "core/study/study_summary.h"

namespace spinaltap {

/// summary.json of a study; docs/studies.md has its keys. What is not finite is null.
Json to_json(const StudySummary& summary);

}  // namespace spinaltap
