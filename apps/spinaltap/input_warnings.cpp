#include "apps/spinaltap/input_warnings.h"

#include "apps/spinaltap/command.h"
#include "core/segment/warning_metadata.h"

namespace spinaltap {

void report_warnings(const char* key, std::span<const std::string> warnings, Json& figures) {
  figures[key] = Json::array();
  for (const std::string& warning : warnings) {
    print_figure("warning", warning);
    figures[key].push_back(warning);
  }
}

void report_input_warnings(std::span<const std::string> warnings, Json& figures) {
  report_warnings("input_warnings", warnings, figures);
}

void report_input_warnings(const BoneModel& bone, Json& figures) {
  report_input_warnings(input_warnings_in(bone.metadata()), figures);
  if (const std::string change = hu_change_in(bone.metadata()); !change.empty()) {
    print_figure("CT numbers changed", change);
    figures["hu_change"] = change;
  }
}

void report_bone_warnings(const BoneModel& bone, Json& figures) {
  report_input_warnings(bone, figures);
  const LevelWarnings marked = warnings_in(bone.metadata()).value_or(LevelWarnings{});
  for (const std::string& warning : marked.warnings) {
    print_figure("warning", (marked.is_suspect() ? "this bone is SUSPECT: " : "the bone: ") + warning);
  }
  figures["bone_warnings"] = marked.warnings;
  figures["bone_severity"] = marked.severity;
}

int say_doubt(const char* label, const std::string& what, bool accepts_warnings) {
  print_figure(
      label,
      what + (accepts_warnings ? ": accepted" : ": the exit code is 1; once you have looked at it, --accept-warnings"));
  return accepts_warnings ? kDone : kAnswerIsNo;
}

int say_input_warnings(std::span<const std::string> warnings, bool accepts_warnings) {
  return warnings.empty() ? kDone : say_doubt("doubtful", "what was read", accepts_warnings);
}

}  // namespace spinaltap
