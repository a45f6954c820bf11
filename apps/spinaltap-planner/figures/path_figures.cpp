#include "apps/spinaltap-planner/figures/path_figures.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "apps/report/text.h"
#include "core/base/error.h"
#include "core/files/data_files.h"
#include "core/files/material_file.h"
#include "core/files/planning_rules_file.h"
#include "core/tool/path_curve.h"
#include "vdb/sim/bone_path.h"

namespace spinaltap {
namespace {

std::string mm_text(double value_mm) { return readable_number(value_mm, 1) + " mm"; }

void add_breach(const std::string& wall, const Approach& approach, double margin_mm,
                std::vector<PathWarning>& warnings) {
  const std::string where = std::string(name_of(approach.side)) + ", " + mm_text(approach.depth_mm) + " deep";
  if (approach.clearance_mm < 0.0) {
    warnings.push_back(
        {WarningLevel::danger, "breaches " + wall + " by " + mm_text(-approach.clearance_mm) + " (" + where + ")"});
  } else if (approach.clearance_mm < margin_mm) {
    warnings.push_back({WarningLevel::caution, "only " + mm_text(approach.clearance_mm) + " to " + wall + " (" + where +
                                                   "); the rule is " + mm_text(margin_mm)});
  }
}

/// `longer_mm`: the screw than its path, from the entry to the target.
void add_length(double longer_mm, std::vector<PathWarning>& warnings) {
  constexpr double kSameMm = 0.5;
  if (longer_mm > kSameMm) {
    warnings.push_back(
        {WarningLevel::caution, "the screw is " + mm_text(longer_mm) +
                                    " longer than the path: with its tip at the target it stands out of its hole"});
  } else if (longer_mm < -kSameMm) {
    warnings.push_back(
        {WarningLevel::caution, "the screw is " + mm_text(-longer_mm) +
                                    " shorter than the path: with its tip at the target its head lies in the hole"});
  }
}

/// What the grade found; its breach is told by walls already.
void add_findings(const PathGrade& grade, std::vector<PathWarning>& warnings) {
  for (const Finding& finding : grade.findings) {
    const bool is_breach = finding.part == InstrumentPart::tool && finding.is_warning && grade.breach_mm > 0.0 &&
                           finding.depth_mm == grade.breach_mm && finding.at_mm == grade.breach_depth_mm;
    if (is_breach) continue;
    warnings.push_back({finding.is_warning ? WarningLevel::caution : WarningLevel::note, finding.words});
  }
}

/// How far a place is from the bone's surface, mm, either side.
double off_surface_mm(const OpenedBone& bone, const Vec3& p_mm) { return (stick_to_surface(bone, p_mm) - p_mm).norm(); }

}  // namespace

PathGrader::PathGrader() {
  const HuToDensity density = read_density_calibration(data_file("densities/vertebra.json")).line;
  material_ = read_material(data_file("materials/vertebra.json"), density);
  const SuggestOptions rules = read_planning_rules(data_file("planning/pedicle.json"));
  options_ = rules.grade;
  margin_mm_ = rules.margin_mm;
  widest_share_ = rules.widest_share;
}

PathFigures PathGrader::figures(const OpenedBone& bone, const DrillPath& path) const {
  PathFigures figures;
  figures.graded.path = path;
  const Landmarks* landmarks = bone.landmarks();
  figures.angles_are_the_vertebras = landmarks != nullptr;
  try {
    check_path_meets_bone(path, bone.model());
    figures.graded.grade = grade_path(bone.bone->walls(), bone.bone->hu_sampler(), material_, path, options_);
    if (!bone.neighbours.empty()) note_neighbours(bone.neighbours, path, figures.graded.grade);
    note_doubts(bone.bone->doubtful(), path, figures.graded.grade);
    figures.graded.surface = bone.bone->surface_error();
    figures.is_graded = true;
  } catch (const Error& error) {
    figures.warnings.push_back({WarningLevel::danger, error.what()});
  }
  const PathGrade& grade = figures.graded.grade;
  const bool is_left = figures.is_graded ? grade.is_left : path.entry_mm.x() > bone.model().bounds_mm().center().x();
  figures.angles = path_angles(PathCurve(path).direction_at(0.0),
                               landmarks != nullptr ? landmarks->axes : Mat3::Identity(), is_left);
  if (!figures.is_graded) return figures;

  std::vector<PathWarning>& warnings = figures.warnings;
  add_breach("the canal", grade.canal, margin_mm_, warnings);
  add_breach("the outer surface", grade.outer, margin_mm_, warnings);
  if (path.screw) add_length(path.screw->length_mm - path.length_mm(), warnings);
  add_findings(grade, warnings);
  if (figures.graded.surface) {
    warnings.push_back({hides_breach(figures.graded) ? WarningLevel::caution : WarningLevel::note,
                        "the surface is " + surface_in_words(figures.graded)});
  }
  if (!may_be_same(path.bone, bone.bone->identity())) {
    warnings.push_back({WarningLevel::danger,
                        "planned for " + words_of(path.bone) + ": this bone is " + words_of(bone.bone->identity())});
  }
  if (const PathCheck check = check_path_on_bone(*bone.bone, path); !check.fits()) {
    warnings.push_back({WarningLevel::danger, check.words(path)});
  } else if (const double off_mm = off_surface_mm(bone, path.entry_mm); off_mm > 1.0) {
    warnings.push_back({WarningLevel::caution, "the entry is " + mm_text(off_mm) + " off the bone's surface"});
  }
  for (const std::string& warning : bone.bone->input_remarks()) {
    warnings.push_back({WarningLevel::caution, "the CT: " + warning});
  }
  if (!bone.bone->input_warnings().empty()) figures.doubt = "the CT";
  if (const std::optional<LevelWarnings> marked = bone.bone->warnings()) {
    constexpr double kDoubtful = 0.3;  // that the CT's border cuts the body alone makes as much
    if (marked->severity >= kDoubtful) figures.doubt += figures.doubt.empty() ? "the bone" : " and the bone";
    for (const std::string& warning : marked->warnings) {
      warnings.push_back({marked->is_suspect() ? WarningLevel::caution : WarningLevel::note, "the bone: " + warning});
    }
  }
  if (landmarks == nullptr) {
    warnings.push_back({WarningLevel::caution, "no canal is known here: " + bone.bone->no_landmarks()});
  } else {
    const double width_mm = (is_left ? landmarks->left_pedicle : landmarks->right_pedicle).width_mm;
    const double tool_mm = path.screw ? path.screw->diameter_mm : path.bit.diameter_mm;
    if (tool_mm > widest_share_ * width_mm) {
      warnings.push_back({WarningLevel::caution, "fills " + readable_number(100.0 * tool_mm / width_mm, 0) +
                                                     " % of the pedicle's width of " + mm_text(width_mm)});
    }
    for (const std::string& warning : landmarks->warnings) warnings.push_back({WarningLevel::note, warning});
  }
  std::stable_sort(warnings.begin(), warnings.end(),
                   [](const PathWarning& a, const PathWarning& b) { return a.level > b.level; });
  return figures;
}

void add_reasons(std::span<const SuggestedPath> suggested, PathFigures& figures) {
  const DrillPath& path = figures.graded.path;
  const auto same = [&](const SuggestedPath& one) {
    return one.path.entry_mm == path.entry_mm && one.path.target_mm == path.target_mm && !path.is_curved() &&
           one.path.screw.has_value() == path.screw.has_value() &&
           (!path.screw || (one.path.screw->diameter_mm == path.screw->diameter_mm &&
                            one.path.screw->length_mm == path.screw->length_mm));
  };
  const auto found = std::find_if(suggested.begin(), suggested.end(), same);
  if (found == suggested.end()) return;
  figures.technique = found->technique;
  figures.reasons = found->reasons;
}

}  // namespace spinaltap
