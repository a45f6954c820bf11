#pragma once

#include <CLI/CLI.hpp>

#include <optional>
#include <string>
#include <vector>

#include "apps/report/grade_output.h"
#include "core/base/progress.h"
#include "vdb/sim/bone.h"

namespace spinaltap {

/// The option of commands that grade paths: --errors.
struct PlacementOptions {
  std::string errors = "robot_726";  ///< a shipped model, "MM,DEG", or "none"

  void add_to(CLI::App& app);
  /// The model; nothing for "none". Throws Error as placement_errors_of() does.
  std::optional<PlacementErrors> model() const;
};

/// Fills in how likely each grade is and what errors do, where there is a model, and how well the CT shows the bone's
/// surface, where that is known.
void add_uncertainty(const Bone& bone, const std::optional<PlacementErrors>& errors, std::vector<GradedPath>& graded,
                     const Progress& progress = {});

/// Prints them, a line each of a path.
void print_uncertainty(const std::vector<GradedPath>& graded);

}  // namespace spinaltap
