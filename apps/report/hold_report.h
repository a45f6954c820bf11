#pragma once

#include <string>
#include <vector>

#include "apps/report/html_report.h"
#include "apps/report/svg_plot.h"
#include "core/grading/screw_hold.h"

namespace spinaltap {

/// "850 (440 to 1,600)": median, 5 and 95 %, to two digits.
std::string banded_text(const HoldFigure& figure);

/// How well a screw holds, in rows for a report's table.
std::vector<ReportRow> hold_rows(const ScrewHold& hold);

/// Along the depth of the screw's tip: the torque that drives it on, with its band.
Plot insertion_torque_plot(const ScrewHold& hold);

}  // namespace spinaltap
