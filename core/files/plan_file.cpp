#include "core/files/plan_file.h"

#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/text_fields.h"
#include "core/files/detail/markups_file.h"
#include "core/files/detail/tool_json.h"

namespace spinaltap {
namespace {

constexpr FileFormat kPlanFormat{"spinaltap-plan", "plan", "plan again, or see docs/plan-file.md"};

/// A plan with a curved path is of a version of its own, so that no program that knows straight ones only drills its
/// chord.
constexpr int kCurvedVersion = 3;
/// Likewise one that names the bone that it is for: a program that does not compare it would drill it in any other.
constexpr int kNamesBoneVersion = 4;

std::vector<DrillPath> paths_of_plan(const Json& json, const std::filesystem::path& file) {
  check_format(json, kPlanFormat, file, {kFormatVersion, kCurvedVersion, kNamesBoneVersion});
  const JsonObject plan(json, file);
  if (plan.text("frame") != "LPS" || plan.text("unit") != "mm") {
    fail("expected a plan in the frame LPS and the unit mm in ", file.string());
  }
  const Json& list = plan.at("paths");
  if (!list.is_array() || list.empty()) fail("expected one path or more in ", file.string(), ", found none");
  std::vector<DrillPath> paths;
  paths.reserve(list.size());
  for (const Json& item : list) paths.push_back(read_path(item, file));
  return paths;
}

std::vector<DrillPath> paths_of(const Json& json, const std::filesystem::path& file) {
  std::vector<DrillPath> paths = is_markups(json) ? paths_of_markups(json, file) : paths_of_plan(json, file);
  for (const DrillPath& drill_path : paths) {
    try {
      check_path(drill_path);
    } catch (const Error& error) {
      fail(file.string(), ": path ", in_quotes(drill_path.name), ": ", error.what());
    }
  }
  return paths;
}

Json plan_of(const std::vector<DrillPath>& paths) {
  Json plan = format_head(kPlanFormat);
  plan.update(Json{{"frame", "LPS"}, {"unit", "mm"}, {"paths", Json::array()}});
  for (const DrillPath& drill_path : paths) {
    plan["paths"].push_back(to_json(drill_path));
    if (drill_path.is_curved() && plan["version"] != kNamesBoneVersion) plan["version"] = kCurvedVersion;
    if (!drill_path.bone.is_empty()) plan["version"] = kNamesBoneVersion;
  }
  return plan;
}

}  // namespace

void write_plan(const std::vector<DrillPath>& paths, const std::filesystem::path& path) {
  write_json(path.string().ends_with(".mrk.json") ? markups_of(paths) : plan_of(paths), path);
}

std::vector<DrillPath> read_plan(const std::filesystem::path& path) { return paths_of(read_json(path), path); }

std::string plan_text(const std::vector<DrillPath>& paths) { return plan_of(paths).dump(2) + "\n"; }

std::vector<DrillPath> paths_of_text(const std::string& text, const std::filesystem::path& file) {
  return paths_of(parse_json(text, file.string()), file);
}

const DrillPath& choose_path(const std::vector<DrillPath>& paths, const std::string& name) {
  std::string names;
  for (const DrillPath& path : paths) {
    if (name.empty() || path.name == name) return path;
    constexpr std::size_t kMaxNames = 400;
    if (names.size() < kMaxNames) names += (names.empty() ? "" : ", ") + shown(path.name);
  }
  fail("expected the name of a path in the plan, found ", in_quotes(name), "; it has: ", names);
}

}  // namespace spinaltap
