#pragma once

#include <string>
#include <vector>

#include "apps/common/grade_output.h"

namespace spinaltap {

/// The report on graded paths as one self-contained HTML file: of each path its grade and nearest approaches, and
/// clearances, CT numbers and predicted thrust along the depth. `notes` come first. Throws Error without a path.
std::string grade_report(const std::string& title, const std::vector<GradedPath>& paths,
                         const std::vector<double>& hu_bands, const std::vector<std::string>& notes = {});

}  // namespace spinaltap
