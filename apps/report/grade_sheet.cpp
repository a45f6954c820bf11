#include "apps/report/grade_sheet.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "apps/report/breach_map.h"
#include "apps/report/fixation_report.h"
#include "apps/report/picture_view.h"
#include "apps/report/slice_figure.h"
#include "apps/report/text.h"
#include "core/grading/path_side.h"
#include "core/tool/path_curve.h"

namespace spinaltap {
namespace {

constexpr double kSheetPlotWidth = 488.0;  ///< at 93 mm of paper its text is 7 points high
constexpr double kSheetPlotHeight = 170.0;

std::string place(const Vec3& p_mm) {
  return readable_number(p_mm.x(), 1) + ", " + readable_number(p_mm.y(), 1) + ", " + readable_number(p_mm.z(), 1);
}

/// One of a sheet's columns: a path, or a pedicle without one.
struct Slot {
  const GradedPath* graded = nullptr;
  const MissingPath* missing = nullptr;
};

const PedicleLandmarks& pedicle_of(const Landmarks& landmarks, bool is_left) {
  return is_left ? landmarks.left_pedicle : landmarks.right_pedicle;
}

std::string side_of(bool is_left) { return is_left ? "Left" : "Right"; }

ReportRow pedicle_row(const Landmarks& landmarks, bool is_left) {
  const PedicleLandmarks& pedicle = pedicle_of(landmarks, is_left);
  return {"Pedicle", readable_number(pedicle.width_mm, 1) + " × " + readable_number(pedicle.height_mm, 1), "mm"};
}

/// What slices and plots do not tell.
std::vector<ReportRow> sheet_figures(const GradedPath& graded, const Landmarks* landmarks) {
  const PathGrade& grade = graded.grade;
  const DrillPath& path = graded.path;
  std::vector<ReportRow> rows;
  if (landmarks != nullptr) {
    const PathAngles angles = path_angles(PathCurve(path).direction_at(0.0), landmarks->axes, grade.is_left);
    const std::string where = path.is_curved() ? ", at entry" : "";
    rows.push_back({"Convergence" + where, readable_number(angles.convergence_deg, 1) + "°", ""});
    rows.push_back({"Inclination" + where, readable_number(angles.inclination_deg, 1) + "°", ""});
    rows.push_back(pedicle_row(*landmarks, grade.is_left));
  }
  if (std::isfinite(grade.hu)) rows.push_back({"Bone in it", readable_number(grade.hu, 0), "HU"});
  rows.push_back({"Entry", place(path.entry_mm), "mm"});
  rows.push_back({"Target", place(path.target_mm), "mm"});
  rows.push_back({"Path", readable_number(path.length_mm(), 1), "mm"});
  rows.push_back({"Thrust", readable_number(grade.max_thrust_n, 0), "N"});
  if (grade.fixation) rows.push_back({"Pull-out", banded_text(grade.fixation->pullout_n), "N"});
  return rows;
}

/// No longer than a sheet has room for; all figures tell the rest.
ReportLines shortened(ReportLines lines, std::size_t max) {
  const std::size_t warnings = std::min(lines.warnings.size(), max);
  const std::size_t others = std::min(lines.lines.size(), max - warnings);
  const std::size_t left_out = lines.warnings.size() + lines.lines.size() - warnings - others;
  lines.warnings.resize(warnings);
  lines.lines.resize(others);
  if (left_out > 0) lines.lines.push_back("and " + std::to_string(left_out) + " more: see all figures");
  return lines;
}

ReportLines findings_of(const PathGrade& grade, std::size_t max) {
  ReportLines lines{"What stands out", {}, {}};
  for (const Finding& finding : grade.findings) {
    (finding.is_warning ? lines.warnings : lines.lines).push_back(finding.words);
  }
  return shortened(std::move(lines), max);
}

class Sheets {
 public:
  Sheets(const GradeReportData& data, const Progress& progress) : data_(data), progress_(progress) {
    if (data.bone != nullptr) outline_ = outlined(*data.bone);
  }

  ReportSheet sheet(const std::vector<Slot>& slots, bool is_first) const {
    ReportSheet made;
    if (!is_first) made.heading = data_.title;
    if (is_first) made.notes = notes();
    for (const Slot& slot : slots) {
      made.columns.push_back(slot.graded != nullptr ? column(*slot.graded, slots) : column(*slot.missing));
    }
    if (data_.bone != nullptr) {
      std::vector<DrillPath> paths;
      for (const Slot& slot : slots) {
        if (slot.graded != nullptr) paths.push_back(slot.graded->path);
      }
      made.pictures = planned_pictures(data_.bone->model(), paths, progress_);
    }
    made.key = key();
    return made;
  }

 private:
  /// What is wrong with the bone itself: all that stands below rests on it.
  std::vector<std::string> notes() const {
    std::vector<std::string> lines = data_.notes;
    if (data_.bone != nullptr) {
      for (const std::string& warning : data_.bone->input_remarks()) lines.push_back("The CT: " + warning);
    }
    const std::optional<LevelWarnings> bone = data_.bone != nullptr ? data_.bone->warnings() : std::nullopt;
    if (bone && !bone->warnings.empty()) {
      std::string line = bone->is_suspect() ? "This bone is SUSPECT, look at it before its paths: " : "The bone: ";
      for (std::size_t n = 0; n < bone->warnings.size(); ++n) line += (n == 0 ? "" : "; ") + bone->warnings[n];
      lines.push_back(line);
    }
    if (data_.landmarks != nullptr) {
      lines.insert(lines.end(), data_.landmarks->warnings.begin(), data_.landmarks->warnings.end());
    }
    return lines;
  }

  SheetColumn column(const GradedPath& graded, const std::vector<Slot>& slots) const {
    const PathGrade& grade = graded.grade;
    SheetColumn made;
    made.heading = side_of(grade.is_left) + " pedicle: " + tool_of(graded.path);
    const std::string name = side_of(grade.is_left);
    if (!graded.path.name.empty() && graded.path.name != (grade.is_left ? "left" : "right")) {
      made.heading += ", " + graded.path.name;
    }
    made.badge = std::string(1, letter_of(grade.grade));
    if (!grade.doubts.empty()) made.badge += ", but";
    made.is_good = !(grade.breach_mm > 0.0) && grade.doubts.empty();
    made.verdict = "Gertzbein-Robbins: " + meaning_of(grade).substr(3);
    if (grade.breach_mm > 0.0) {
      made.verdict += ", " + readable_number(grade.breach_mm, 2) + " mm into " + breach_of(grade) + ", " +
                      readable_number(grade.breach_depth_mm, 1) + " mm deep";
    }
    made.verdict += std::string(" · Heary ") + name_of(grade.heary) + " · Rampersaud " + grade.rampersaud + " · Babu " +
                    std::to_string(grade.facet);
    if (data_.ct != nullptr) {
      SliceScene scene = scene_of(graded.path);
      scene.red_from_mm = grade.opening_end_mm;  // from where on the grade counts
      for (const Slot& other : slots) {
        if (other.graded != nullptr && other.graded != &graded) scene.others.push_back(other.graded->path);
      }
      made.slices = page_slices(*data_.ct, scene, data_.bone_bounds_mm, isthmus_mm(graded));
      made.narrow_from = 3;
    }
    made.figures = sheet_figures(graded, data_.landmarks);
    if (graded.safe && !graded.placed && !(grade.breach_mm > 0.0)) {  // the map tells more
      const SafeZone& safe = *graded.safe;
      const auto mm = [](double value) { return readable_number(value, 1) + " mm"; };
      const auto degrees = [](double value) { return readable_number(value, 1) + "°"; };
      made.grid_head = {"Until it breaches", "medial", "lateral", "cranial", "caudal"};
      made.grid = {{"entry off", mm(safe.medial_mm), mm(safe.lateral_mm), mm(safe.cranial_mm), mm(safe.caudal_mm)},
                   {"turned", degrees(safe.medial_deg), degrees(safe.lateral_deg), degrees(safe.cranial_deg),
                    degrees(safe.caudal_deg)}};
    }
    Plot plot = clearance_plot(graded);
    plot.title.clear();  // its axis says it
    plot.width = kSheetPlotWidth;
    plot.height = kSheetPlotHeight;
    made.plots.push_back({svg_plot(plot), ""});
    if (graded.placed) made.plots.push_back({breach_map_svg(*graded.placed), ""});
    const std::size_t max_lines = notes().empty() ? 3 : 2;  // what the bone is told to lack needs the room
    made.lists.push_back(findings_of(grade, max_lines));
    if (graded.surface) {
      ReportLines& list = made.lists.back();
      (hides_breach(graded) ? list.warnings : list.lines).push_back("Surface " + surface_in_words(graded));
    }
    const auto index = static_cast<std::size_t>(&graded - data_.paths.data());
    if (index < data_.reasons.size())
      made.lists.push_back(shortened({"Why this path", {}, data_.reasons[index]}, max_lines));
    return made;
  }

  SheetColumn column(const MissingPath& missing) const {
    SheetColumn made;
    made.heading = side_of(missing.is_left) + " pedicle";
    made.badge = "no path";
    made.is_good = false;
    const PedicleLandmarks& pedicle = pedicle_of(*data_.landmarks, missing.is_left);
    if (data_.ct != nullptr) {
      // The screw as it would lie, most of it beyond the isthmus.
      DrillPath path;
      const double length_mm = missing.smallest ? missing.smallest->length_mm : 25.0;
      path.entry_mm = pedicle.isthmus_mm - 0.4 * length_mm * pedicle.axis;
      path.target_mm = path.entry_mm + length_mm * pedicle.axis;
      path.screw = missing.smallest;
      if (path.screw) path.screw->head.diameter_mm = 0.0;
      SliceScene scene = scene_of(path);
      scene.red_from_mm = 0.4 * length_mm - 4.0;
      made.slices = isthmus_slices(*data_.ct, scene, data_.bone_bounds_mm, pedicle);
    }
    made.figures.push_back(pedicle_row(*data_.landmarks, missing.is_left));
    made.figures.push_back({"Isthmus", place(pedicle.isthmus_mm), "mm"});
    if (missing.smallest) {
      made.figures.push_back({"Smallest screw of the table", readable_number(missing.smallest->diameter_mm, 1), "mm"});
    }
    made.lists.push_back({"Why", {missing.reason}, {}});
    return made;
  }

  SliceScene scene_of(const DrillPath& path) const {
    SliceScene scene;
    scene.path = path;
    if (data_.bone != nullptr) scene.bone = &outline_;
    return scene;
  }

  /// Along the path; half-way where no isthmus is known.
  double isthmus_mm(const GradedPath& graded) const {
    if (data_.landmarks == nullptr) return 0.5 * graded.path.length_mm();
    const PedicleLandmarks& pedicle = pedicle_of(*data_.landmarks, graded.grade.is_left);
    return PathCurve(graded.path).nearest_mm(pedicle.isthmus_mm);
  }

  bool has_map() const {
    return std::any_of(data_.paths.begin(), data_.paths.end(),
                       [](const GradedPath& one) { return one.placed.has_value(); });
  }

  std::string key() const {
    std::string text;
    if (data_.ct != nullptr) {
      text += data_.has_own_ct ? "Slices of the CT" : "Slices of the CT numbers that the bone keeps (not the whole CT)";
      text +=
          ", bone window (level 500, width 1,800 HU); axial from the feet, sagittal from the patient's left; across "
          "the path at its isthmus and tip, seen from behind along it. Blue: the screw or bit, solid where the plane "
          "cuts it, dashed its projection. ";
    }
    if (data_.bone != nullptr) text += "Yellow: the bone's surface. Pink: the canal's wall. Red: beyond the bone. ";
    if (data_.landmarks != nullptr) {
      if (has_map()) text += "Map: dark green where over 1 mm of bone is left, then A to E. ";
      text += "Convergence is towards the midline, inclination towards the head, both to the vertebra's own planes.";
    }
    return text;
  }

  const GradeReportData& data_;
  const Progress& progress_;
  OutlinedBone outline_;
};

}  // namespace

std::vector<ReportSheet> grade_sheets(const GradeReportData& data, const Progress& progress) {
  std::vector<Slot> left, right;
  for (const GradedPath& graded : data.paths) (graded.grade.is_left ? left : right).push_back({&graded, nullptr});
  for (const MissingPath& missing : data.missing) (missing.is_left ? left : right).push_back({nullptr, &missing});
  const Sheets sheets(data, progress);
  std::vector<ReportSheet> made;
  for (std::size_t n = 0; n < std::max(left.size(), right.size()); ++n) {
    std::vector<Slot> slots;
    if (n < right.size()) slots.push_back(right[n]);
    if (n < left.size()) slots.push_back(left[n]);
    made.push_back(sheets.sheet(slots, n == 0));
  }
  return made;
}

}  // namespace spinaltap
