#include "core/files/detail/markups_file.h"

#include <array>
#include <nlohmann/json.hpp>
#include <string>

#include "core/base/error.h"
#include "core/base/text_fields.h"
#include "core/files/detail/tool_json.h"

namespace spinaltap {
namespace {

constexpr const char* kSchema =
    "https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/Resources/Schema/"
    "markups-schema-v1.0.3.json#";

Json control_point(int number, const char* label, const Vec3& p_mm) {
  return {{"id", std::to_string(number)},
          {"label", label},
          {"description", ""},
          {"associatedNodeID", ""},
          {"position", to_json(p_mm)},
          {"orientation", {-1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 1.0}},
          {"selected", true},
          {"locked", false},
          {"visibility", true},
          {"positionStatus", "defined"}};
}

/// How a markup's numbers become patient LPS, mm.
Vec3 scale_to_lps_mm(const JsonObject& markup, const std::filesystem::path& file) {
  Vec3 scale = Vec3::Ones();
  const std::string frame = markup.has("coordinateSystem") ? markup.text("coordinateSystem") : "LPS";
  if (frame == "RAS") {
    scale = Vec3(-1.0, -1.0, 1.0);
  } else if (frame != "LPS") {
    fail("expected \"coordinateSystem\" to be LPS or RAS in ", file.string(), ", found ", in_quotes(frame));
  }
  if (!markup.has("coordinateUnits")) return scale;
  // A word, or a term of a dictionary whose first part is that word.
  const Json& units = markup.at("coordinateUnits");
  const Json& unit = units.is_array() && !units.empty() ? units.front() : units;
  if (unit == "um") return 1e-3 * scale;
  if (unit != "mm")
    fail("expected \"coordinateUnits\" to be mm or um in ", file.string(), ", found ", shown_value(units));
  return scale;
}

bool is_called(const JsonObject& point, std::string_view name) {
  if (!point.has("label") || !point.at("label").is_string()) return false;
  return lower_case(point.text("label")) == name;
}

DrillPath path_of_line(const Json& json, const std::string& name, const std::filesystem::path& file,
                       const DrillBit& bit) {
  const JsonObject markup(json, file);
  const Vec3 scale = scale_to_lps_mm(markup, file);
  const Json& points = markup.at("controlPoints");
  if (!points.is_array() || points.size() != 2) {
    fail("expected line ", in_quotes(name), " to have two points in ", file.string(), ", found ",
         points.is_array() ? points.size() : 0);
  }
  std::array<Vec3, 2> ends_mm;
  for (std::size_t n = 0; n < 2; ++n) {
    const JsonObject point(points[n], file);
    if (point.has("positionStatus") && point.text("positionStatus") != "defined") {
      fail("expected both points of line ", in_quotes(name), " to be placed in ", file.string());
    }
    ends_mm[n] = point.vector("position").cwiseProduct(scale);
  }
  const JsonObject first(points[0], file);
  const JsonObject second(points[1], file);
  if (is_called(first, "target") || is_called(second, "entry")) std::swap(ends_mm[0], ends_mm[1]);
  DrillPath path{name, ends_mm[0], ends_mm[1], bit};
  if (markup.has("spinaltap")) {
    const JsonObject ours(markup.at("spinaltap"), file);
    path.bit = read_bit(ours.at("bit"), file);
    if (ours.has("screw")) path.screw = read_screw(ours.at("screw"), file);
  }
  return path;
}

}  // namespace

Json markups_of(const std::vector<DrillPath>& paths) {
  Json file{{"@schema", kSchema}, {"markups", Json::array()}};
  for (const DrillPath& path : paths) {
    Json ours{{"bit", to_json(path.bit)}};
    if (path.screw) ours["screw"] = to_json(*path.screw);
    file["markups"].push_back(
        {{"type", "Line"},
         {"name", path.name},
         {"coordinateSystem", "LPS"},
         {"coordinateUnits", "mm"},
         {"locked", false},
         {"fixedNumberOfControlPoints", false},
         {"labelFormat", "%N-%d"},
         {"lastUsedControlPointNumber", 2},
         {"controlPoints", {control_point(1, "entry", path.entry_mm), control_point(2, "target", path.target_mm)}},
         {"measurements", Json::array()},
         {"spinaltap", ours}});
  }
  return file;
}

bool is_markups(const Json& json) { return json.is_object() && json.contains("markups"); }

std::vector<DrillPath> paths_of_markups(const Json& json, const std::filesystem::path& file, const DrillBit& bit) {
  const Json& markups = JsonObject(json, file).at("markups");
  if (!markups.is_array()) fail("expected \"markups\" to be a list in ", file.string());
  std::vector<DrillPath> paths;
  for (const Json& item : markups) {
    const JsonObject markup(item, file);
    if (markup.text("type") != "Line") continue;
    const bool is_named = markup.has("name") && markup.at("name").is_string() && !markup.text("name").empty();
    paths.push_back(
        path_of_line(item, is_named ? markup.text("name") : "line " + std::to_string(paths.size() + 1), file, bit));
  }
  if (paths.empty()) fail("expected a line from the entry to the target among the markups in ", file.string());
  return paths;
}

}  // namespace spinaltap
