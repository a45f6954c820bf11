#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/report/grade_output.h"
#include "apps/spinaltap-planner/opened_bone.h"
#include "core/grading/path_side.h"
#include "core/plan/suggest.h"
#include "core/points/material.h"

namespace spinaltap {

enum class WarningLevel { note, caution, danger };

/// What a person should know of a path, in a line.
struct PathWarning {
  WarningLevel level = WarningLevel::note;
  std::string text;
};

/// What the window tells of a path.
struct PathFigures {
  GradedPath graded;
  PathAngles angles;  ///< to the vertebra's own planes where its landmarks are known, else to the patient's
  bool angles_are_the_vertebras = false;
  bool is_graded = false;                   ///< the path goes through the bone
  std::vector<PathWarning> warnings;        ///< the worst first; the grade's findings are among them
  std::string doubt = {};                   ///< what a grade leans on that may be wrong: "the bone"; empty: nothing
  std::optional<Technique> technique = {};  ///< of a path that is as it was suggested
  std::vector<std::string> reasons = {};    ///< why it was, likewise
};

/// Adds technique and reasons where the path is one of those suggested: same ends, same screw.
void add_reasons(std::span<const SuggestedPath> suggested, PathFigures& figures);

/// Works out figures of paths; reads material and rules once, from the shipped files.
class PathGrader {
 public:
  /// Throws Error where a shipped file is missing or damaged.
  PathGrader();

  /// In a few ms. Throws nothing on paths that make no sense through this bone: the warnings say so.
  PathFigures figures(const OpenedBone& bone, const DrillPath& path) const;

  const std::vector<double>& hu_bands() const { return options_.hu_bands; }
  const Material& material() const { return material_; }

 private:
  Material material_;
  GradeOptions options_;
  double margin_mm_ = 1.0;     ///< of bone around a screw, below which there is a caution
  double widest_share_ = 0.8;  ///< of the pedicle's width, the same
};

}  // namespace spinaltap
