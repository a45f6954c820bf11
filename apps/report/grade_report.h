#pragma once

#include <string>
#include <vector>

#include "apps/common/grade_output.h"
#include "core/ct/ct_volume.h"

namespace spinaltap {

/// The report on graded paths as one self-contained HTML file: of each path its grade and nearest approaches, and
/// clearances, CT numbers and predicted thrust along the depth, and slices of `ct` with its tool. `bone_bounds_mm`: what
/// the slices show. `notes` come first. Throws Error without a path.
std::string grade_report(const std::string& title, const std::vector<GradedPath>& paths,
                         const std::vector<double>& hu_bands, const CtVolume& ct, const Box3& bone_bounds_mm,
                         const std::vector<std::string>& notes = {});

}  // namespace spinaltap
