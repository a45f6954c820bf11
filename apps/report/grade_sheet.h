#pragma once

#include <vector>

#include "apps/report/grade_report.h"
#include "apps/report/html_report.h"

namespace spinaltap {

/// The pages of paper of a report on graded paths: the n-th right path beside the n-th left one, as on an axial slice.
std::vector<ReportSheet> grade_sheets(const GradeReportData& data, const Progress& progress = {});

}  // namespace spinaltap
