#pragma once

#include <string>
#include <vector>

#include "apps/report/html_report.h"
#include "apps/report/svg_plot.h"
#include "core/grading/screw_fixation.h"

namespace spinaltap {

/// "850 (440 to 1,600)": median, 5 and 95 %, to two digits.
std::string banded_text(const FixationFigure& figure);

/// How well a screw holds, in rows for a report's table.
std::vector<ReportRow> fixation_rows(const ScrewFixation& fixation);

/// Along the depth of the screw's tip: the torque that drives it on, with its band.
Plot insertion_torque_plot(const ScrewFixation& fixation);

}  // namespace spinaltap
