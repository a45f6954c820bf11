#pragma once

#include <string>
#include <vector>

#include "apps/report/grade_output.h"
#include "apps/report/svg_plot.h"
#include "core/ct/ct_volume.h"

namespace spinaltap {

/// "B: breach below 2 mm".
std::string meaning_of(Grade grade);

/// Along the depth of a graded path: clearances to both walls, the mean CT number, the shares of bone in bands of CT
/// numbers, and the predicted thrust.
Plot clearance_plot(const GradedPath& graded);
Plot hu_plot(const GradedPath& graded);
Plot bands_plot(const GradedPath& graded, const std::vector<double>& hu_bands);
Plot predicted_thrust_plot(const GradedPath& graded);

/// Graded paths through one vertebra.
struct GradeReportData {
  std::string title;
  std::vector<GradedPath> paths;
  std::vector<double> hu_bands;
  const Landmarks* landmarks = nullptr;  ///< none: no table of the vertebra
  const CtVolume* ct = nullptr;          ///< for slices with the tool; none without it
  Box3 bone_bounds_mm;                   ///< what the slices show, patient LPS
};

/// The report as one self-contained HTML file: what was found of the vertebra, warnings first; of each path its grade,
/// nearest approaches and safe zone, slices, and clearances, CT numbers and predicted thrust along the depth. Throws
/// Error without a path.
std::string grade_report(const GradeReportData& data);

}  // namespace spinaltap
