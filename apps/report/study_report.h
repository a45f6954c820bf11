#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/report/html_report.h"
#include "core/files/study_folder.h"
#include "core/study/study_summary.h"

namespace spinaltap {

struct StudyReportData {
  std::string title;
  std::vector<ReportRow> inputs;  ///< what was studied
  std::vector<StudyRow> rows;     ///< in the order of their numbers
  StudySummary summary;           ///< of them
};

/// A study as one self-contained HTML file: how likely a breach is, on the whole and over each factor, with 95 %
/// intervals; grades; distributions of thrust, torque, plunge depth and clearance; where entries lay that breached. The
/// same rows give the same bytes. Throws Error without a row.
std::string study_report(const StudyReportData& data);

/// What the report says of it.
struct StudyInputs {
  std::string title;
  StudyDesign design;
  StudyGround ground;
  std::vector<ReportRow> rows;
};
/// Throws Error that names `file` and the key at fault.
StudyInputs study_inputs(const StudyIdentity& identity, const std::filesystem::path& file);

/// Writes runs.csv, summary.json, breach_map.csv and report.html of a study whose runs are all there: from study.json
/// and the rows alone, so that the bytes do not depend on who drilled what, where and when. Throws Error where runs are
/// missing.
StudySummary write_study_results(const std::filesystem::path& folder, const StudyIdentity& identity,
                                 const StudyRows& rows);

}  // namespace spinaltap
