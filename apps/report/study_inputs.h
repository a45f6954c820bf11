#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/report/html_report.h"
#include "core/files/study_identity.h"

namespace spinaltap {

/// What the report says of it.
struct StudyInputs {
  std::string title;
  StudyDesign design;
  std::vector<ReportRow> rows;
};
/// Throws Error that names `file` and the key at fault.
StudyInputs study_inputs(const StudyIdentity& identity, const std::filesystem::path& file);

}  // namespace spinaltap
