#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/report/grade_output.h"
#include "apps/report/svg_plot.h"
#include "core/base/progress.h"
#include "core/ct/ct_volume.h"
#include "vdb/sim/bone.h"

namespace spinaltap {

/// "B: breach below 2 mm".
std::string meaning_of(Grade grade);
/// The same with what the grade leans on: "A: no breach, but 3.2 mm of it lie in slices that were made up".
std::string meaning_of(const PathGrade& grade);

/// Along the depth of a graded path: clearances to both walls, the mean CT number, the shares of bone in bands of CT
/// numbers, and the predicted thrust.
Plot clearance_plot(const GradedPath& graded);
Plot hu_plot(const GradedPath& graded);
Plot bands_plot(const GradedPath& graded, const std::vector<double>& hu_bands);
Plot predicted_thrust_plot(const GradedPath& graded);

/// A pedicle through which no path was found.
struct MissingPath {
  bool is_left = true;
  std::string reason;
  std::optional<PedicleScrew> smallest = {};  ///< that was thought of; drawn along the pedicle's axis
};

/// Graded paths through one vertebra.
struct GradeReportData {
  std::string title;
  std::vector<GradedPath> paths;
  std::vector<double> hu_bands;
  const Landmarks* landmarks = nullptr;  ///< none: no table of the vertebra
  const CtVolume* ct = nullptr;          ///< for slices with the tool; none without it
  Box3 bone_bounds_mm;                   ///< what the slices show, patient LPS
  std::vector<MissingPath> missing = {};
  std::vector<std::vector<std::string>> reasons = {};  ///< for each path, in words; fewer where none are told
  const Bone* bone = nullptr;  ///< for its outline on slices, and for pictures from four sides; none without it
  bool has_own_ct = false;     ///< `ct` is the CT itself, not the CT numbers that the bone keeps
  std::string command = {};    ///< that made the report, without names; empty: not told
  std::string date = {};       ///< "2026-11-24"; empty: not told
  std::vector<std::string> notes = {};  ///< on the plan and the bone, shown above all that rests on them
};

/// The report as one self-contained HTML file. Pages of paper come first, one for each pair of a right and a left path:
/// slices with the tool, figures, clearances along the depth, what stands out and why the path was chosen, pictures
/// from four sides; of a pedicle without a path its isthmus and the reason. Then all figures, and CT numbers and
/// predicted thrust along the depth. Throws Error without a path or a missing one, and where one is missing and there
/// are no landmarks.
std::string grade_report(const GradeReportData& data, const Progress& progress = {});

}  // namespace spinaltap
