#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/ct/made_up_slices.h"
#include "core/grading/path_findings.h"
#include "core/tool/drill_path.h"

namespace spinaltap {

/// "3.2 mm of it lie in slices that were made up", to stand behind "A, but ".
std::string in_words(const PathDoubt& doubt);

/// What a path's screw or, where it has none, its bit leans on, at steps of 0.25 mm from the entry to the target:
/// slices that were made up, and unsure bone without which the tool would stand out by more than 1 mm. Throws Error on
/// a path that makes no sense.
std::vector<PathDoubt> path_doubts(const DoubtfulBone& bone, const DrillPath& path);

}  // namespace spinaltap
