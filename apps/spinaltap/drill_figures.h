#pragma once

#include "apps/report/drilling_report.h"
#include "core/files/json_file.h"

namespace spinaltap {

/// For people, on standard output. `density`: the law of the session's material.
void print_drilling(const DrillFigures& figures, const DensityCalibration& density);
Json drilling_json(const DrillFigures& figures, const DensityCalibration& density);

}  // namespace spinaltap
