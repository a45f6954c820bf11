#pragma once

#include <CLI/CLI.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/report/grade_output.h"
#include "apps/spinaltap/plan_check.h"
#include "core/base/progress.h"
#include "core/registration/registration.h"
#include "vdb/sim/bone.h"

namespace spinaltap {

/// How screws err, and how the registration does that guides them.
struct PlacementModel {
  std::optional<PlacementErrors> errors;
  std::optional<Registration> registration;
  std::string registration_name;
};

/// The options of commands that grade paths: --errors and --registration.
struct PlacementOptions {
  std::string errors = "robot_726";  ///< a shipped model, "MM,DEG", or "none"
  std::filesystem::path registration;

  void add_to(CLI::App& app);
  /// Nothing for "none" and where no registration is given. Throws Error as placement_errors_of() and
  /// read_registration() do.
  PlacementModel model() const;
};

/// Fills in how likely each grade is and what errors do, where something errs, and how well the CT shows the bone's
/// surface, where that is known.
void add_uncertainty(const Bone& bone, const PlacementModel& model, std::vector<GradedPath>& graded,
                     const Progress& progress = {});

/// Throws Error where the registration names another bone, unless the options take that.
void check_registration(const PlacementModel& model, const Bone& bone, const PlanCheckOptions& options,
                        PlanFindings& findings);

/// Prints them, a line each of a path.
void print_uncertainty(const std::vector<GradedPath>& graded);

}  // namespace spinaltap
