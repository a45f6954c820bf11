#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/spinaltap/placement_options.h"
#include "apps/spinaltap/report_options.h"
#include "core/base/progress.h"
#include "core/files/json_file.h"
#include "vdb/sim/auto_plan.h"

namespace spinaltap {

struct PlanLevelsOptions {
  std::filesystem::path spine;      ///< spine.vdb
  std::vector<std::string> levels;  ///< names, or "all"
  std::filesystem::path folder;     ///< for T9.json, T9.html, ..., rods.json
  AutoPlanOptions suggest;
  PlacementOptions placement;
  PageOptions page;  ///< of all reports
  PlanCheckOptions check = {};
};

/// Plans each level of a spine.vdb, both sides, with heads that lie in line for a rod: a plan and a report a level,
/// rods.json, and the list of these files; what an earlier list names and this one does not is removed. Prints what was
/// found; `exit_code` becomes that of "the answer is no" where a pedicle gets no path.
Json plan_levels(const PlanLevelsOptions& options, int& exit_code, const Progress& progress);

}  // namespace spinaltap
