#pragma once

#include <string>
#include <vector>

#include "apps/report/grade_output.h"
#include "core/ct/ct_volume.h"

namespace spinaltap {

/// Graded paths through one vertebra.
struct GradeReportData {
  std::string title;
  std::vector<GradedPath> paths;
  std::vector<double> hu_bands;
  const Landmarks* landmarks = nullptr;  ///< none: no table of the vertebra
  const CtVolume* ct = nullptr;          ///< for slices with the tool; none without it
  Box3 bone_bounds_mm;                   ///< what the slices show, patient LPS
};

/// The report as one self-contained HTML file: what was found of the vertebra, doubts first; of each path its grade,
/// nearest approaches and safe zone, slices, and clearances, CT numbers and predicted thrust along the depth. Throws
/// Error without a path.
std::string grade_report(const GradeReportData& data);

}  // namespace spinaltap
