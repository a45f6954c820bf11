#pragma once

#include <vector>

#include "apps/report/html_report.h"
#include "core/files/json_file.h"
#include "vdb/sim/solve_heat.h"

namespace spinaltap {

/// What the heat of a drilling came to, for people: the hottest place, volumes that got too hot, temperatures away from
/// the wall, and where the heat went.
std::vector<ReportRow> heat_rows(const SolvedHeat& heat);
/// The same for programs; docs/heat.md has the keys.
Json heat_json(const SolvedHeat& heat);

}  // namespace spinaltap
