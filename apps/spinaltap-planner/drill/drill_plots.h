#pragma once

#include <span>
#include <vector>

#include "apps/report/svg_plot.h"
#include "core/session/depth_log.h"
#include "core/session/session_event.h"

namespace spinaltap {

/// What is shown along the depth of a drilling.
enum class DrillCurve { thrust, torque, density, clearance };

/// Rows of a log as a curve, from the entry to the target of a path so long (mm) and as far as the rows reach.
Plot drill_plot(DrillCurve curve, std::span<const DepthRow> rows, double length_mm);

}  // namespace spinaltap
