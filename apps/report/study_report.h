#pragma once

#include <string>
#include <vector>

#include "apps/report/html_report.h"
#include "core/study/study_summary.h"

namespace spinaltap {

struct StudyReportData {
  std::string title;
  std::vector<ReportRow> inputs;  ///< what was studied
  std::vector<StudyRow> rows;     ///< in the order of their numbers
  StudySummary summary;           ///< of them
};

/// A study as one self-contained HTML file: how likely a breach is, on the whole and over each factor, with 95 %
/// intervals; grades; distributions of thrust, torque, overshoot and clearance; where entries lay that breached. The
/// same rows give the same bytes. Throws Error without a row.
std::string study_report(const StudyReportData& data);

}  // namespace spinaltap
