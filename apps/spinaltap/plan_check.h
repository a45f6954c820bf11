#pragma once

#include <CLI/CLI.hpp>

#include <span>
#include <string>
#include <vector>

#include "core/ct/bone_identity.h"
#include "core/files/json_file.h"
#include "core/grading/path_check.h"
#include "core/tool/drill_path.h"
#include "vdb/sim/bone.h"

namespace spinaltap {

/// The options of commands that take a plan to a bone.
struct PlanCheckOptions {
  bool takes_other_ct = false;
  bool accepts_warnings = false;
  bool forces_path = false;
  bool from_the_front = false;

  void add_other_ct(CLI::App& app);
  void add_accept_warnings(CLI::App& app);
  void add_force_path(CLI::App& app);
  void add_from_front(CLI::App& app);

  /// What to do about a bone that is another than the one that was named, for the end of a message.
  static const char* other_ct_remedy();
  /// Throws Error where `what` names another bone, unless that is taken; then `notes` get a line that says so.
  void check_same(const std::string& what, const BoneIdentity& named, const BoneIdentity& bone,
                  std::vector<std::string>& notes) const;
  /// The same of a registration, of which `notes` also say where it names no CT. `name`: its file's.
  void check_registration(const std::string& name, const BoneIdentity& named, const BoneIdentity& bone,
                          std::vector<std::string>& notes) const;
  /// The same of a plan's paths, those that name a bone; one note where some name no CT.
  void check_paths(std::span<const DrillPath> paths, const BoneIdentity& bone, std::vector<std::string>& notes) const;
};

/// What is to be said of paths and the bone that they were taken to, a line each.
struct PlanFindings {
  std::vector<std::string> notes;     ///< for whoever reads the results: which CT, and what was taken all the same
  std::vector<std::string> warnings;  ///< paths that do not fit the bone, speeds that do not fit the tool

  /// Notes and warnings, for a report's page.
  std::vector<std::string> lines() const;
};

/// Throws Error where a path names another CT or level, unless the options take it. `tolerance_mm`: see
/// PathCheckOptions.
PlanFindings check_plan(const Bone& bone, std::span<const DrillPath> paths, const PlanCheckOptions& options,
                        double tolerance_mm = PathCheckOptions().tolerance_mm);

/// Puts the findings, and which bone it is, into `figures`: "bone", "plan_notes", "plan_warnings".
void add_findings(const Bone& bone, const PlanFindings& findings, Json& figures);
/// Prints them, and what warnings mean. Gives the exit code.
int say_findings(const PlanFindings& findings, bool accepts_warnings);

}  // namespace spinaltap
