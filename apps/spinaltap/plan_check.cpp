#include "apps/spinaltap/plan_check.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "apps/spinaltap/command.h"
#include "apps/spinaltap/input_warnings.h"
#include "core/base/text_fields.h"
#include "vdb/sim/bone_identity.h"
#include "vdb/sim/bone_path.h"

namespace spinaltap {

void PlanCheckOptions::add_other_ct(CLI::App& app) {
  app.add_flag("--other-ct", takes_other_ct,
               "Take what names another CT or another vertebra all the same; the results say so");
}

void PlanCheckOptions::add_accept_warnings(CLI::App& app) {
  app.add_flag("--accept-warnings", accepts_warnings, "Exit with 0 in spite of warnings, which stay written");
}

void PlanCheckOptions::add_force_path(CLI::App& app) {
  app.add_flag("--force-path", forces_path, "Drill a path that does not fit the bone; the results say so");
}

void PlanCheckOptions::add_from_front(CLI::App& app) {
  app.add_flag("--from-front", from_the_front, "Paths may enter the vertebra from its front");
}

const char* PlanCheckOptions::other_ct_remedy() { return ", or --other-ct to take it all the same"; }

void PlanCheckOptions::check_same(const std::string& what, const BoneIdentity& named, const BoneIdentity& bone,
                                  std::vector<std::string>& notes) const {
  if (!takes_other_ct) {
    check_same_bone(what, named, bone, other_ct_remedy());
  } else if (!may_be_same(named, bone)) {
    notes.push_back(what + " is of " + words_of(named) + ", the bone is " + words_of(bone) +
                    ": taken all the same, as --other-ct says");
  }
}

void PlanCheckOptions::check_registration(const std::string& name, const BoneIdentity& named, const BoneIdentity& bone,
                                          std::vector<std::string>& notes) const {
  const std::string what = "registration " + name;
  if (!named.names_ct()) notes.push_back(what + " does not name its CT");
  check_same(what, named, bone, notes);
}

void PlanCheckOptions::check_paths(std::span<const DrillPath> paths, const BoneIdentity& bone,
                                   std::vector<std::string>& notes) const {
  for (const DrillPath& path : paths) {
    if (!path.bone.is_empty()) check_same("plan, path " + in_quotes(path.name) + ",", path.bone, bone, notes);
  }
  if (std::ranges::any_of(paths, [](const DrillPath& path) { return !path.bone.names_ct(); })) {
    notes.emplace_back("this plan does not name its CT: nothing tells whether it was made for this bone");
  }
}

std::vector<std::string> PlanFindings::lines() const {
  std::vector<std::string> all = notes;
  all.insert(all.end(), warnings.begin(), warnings.end());
  return all;
}

PlanFindings check_plan(const Bone& bone, std::span<const DrillPath> paths, const PlanCheckOptions& options,
                        double tolerance_mm) {
  PlanFindings findings;
  options.check_paths(paths, bone.identity(), findings.notes);
  for (const DrillPath& path : paths) {
    const PathCheck check =
        check_path_on_bone(bone, path, {.tolerance_mm = tolerance_mm, .from_the_front = options.from_the_front});
    if (!check.fits()) findings.warnings.push_back(check.words(path));
  }
  return findings;
}

void add_findings(const Bone& bone, const PlanFindings& findings, Json& figures) {
  figures["bone"] = {{"ct", bone.identity().ct_hash}, {"level", level_name(bone.identity().level)}};
  figures["plan_notes"] = findings.notes;
  figures["plan_warnings"] = findings.warnings;
}

int say_findings(const PlanFindings& findings, bool accepts_warnings) {
  for (const std::string& note : findings.notes) print_figure("note", note);
  for (const std::string& warning : findings.warnings) print_figure("warning", warning);
  return findings.warnings.empty() ? kDone : say_doubt("doubtful", "the plan", accepts_warnings);
}

}  // namespace spinaltap
