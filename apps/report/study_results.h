#pragma once

#include <filesystem>

#include "core/files/study_folder.h"
#include "core/study/study_summary.h"

namespace spinaltap {

/// Writes runs.csv, summary.json and report.html of a study whose runs are all there: from study.json and the rows
/// alone, so that the bytes do not depend on who drilled what, where and when. Throws Error where runs are missing.
StudySummary write_study_results(const std::filesystem::path& folder, const StudyIdentity& identity,
                                 const StudyRows& rows);

}  // namespace spinaltap
