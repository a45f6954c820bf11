#pragma once

#include <filesystem>

#include "core/study/study_summary.h"

namespace spinaltap {

/// Prints a study's summary and where its report is.
void print_study(const StudySummary& summary, const std::filesystem::path& folder);

}  // namespace spinaltap
