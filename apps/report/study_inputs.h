#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/files/study_folder.h"
#include "core/files/study_spec_file.h"
#include "apps/report/html_report.h"

namespace spinaltap {

/// What a study's results depend on. `spec.volume.radius_mm` must be known by now.
StudyIdentity study_identity(const StudySpec& spec, const StudyRuns& runs, const std::string& bone_hash);

/// What the report says of it.
struct StudyInputs {
  std::string title;
  StudyDesign design;
  std::vector<ReportRow> rows;
};
/// Throws Error that names `file` and the key at fault.
StudyInputs study_inputs(const StudyIdentity& identity, const std::filesystem::path& file);

}  // namespace spinaltap
