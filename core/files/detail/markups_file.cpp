#include "core/files/detail/markups_file.h"

#include <algorithm>
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

bool is_called(const JsonObject& point, std::string_view name) {
  if (!point.has("label") || !point.at("label").is_string()) return false;
  return lower_case(point.text("label")) == name;
}

DrillPath path_of_markup(const Json& json, bool is_curve, const std::string& name, const std::filesystem::path& file,
                         const DrillBit& bit) {
  const JsonObject markup(json, file);
  const Vec3 scale = detail::scale_to_lps_mm(markup, file);
  const Json& points = markup.at("controlPoints");
  const std::size_t count = points.is_array() ? points.size() : 0;
  if (is_curve ? count < 2 || count > kMaxVias + 2 : count != 2) {
    fail("expected ", is_curve ? "curve " : "line ", in_quotes(name), " to have two points",
         is_curve ? " and up to " + std::to_string(kMaxVias) + " between" : std::string(), " in ", file.string(),
         ", found ", count);
  }
  std::vector<Vec3> places_mm;
  for (std::size_t n = 0; n < count; ++n) {
    const JsonObject point(points[n], file);
    if (point.has("positionStatus") && point.text("positionStatus") != "defined") {
      fail("expected ", is_curve ? "all points of curve " : "both points of line ", in_quotes(name),
           " to be placed in ", file.string());
    }
    places_mm.push_back(point.vector("position").cwiseProduct(scale));
  }
  const JsonObject first(points[0], file);
  const JsonObject last(points[count - 1], file);
  if (is_called(first, "target") || is_called(last, "entry")) std::reverse(places_mm.begin(), places_mm.end());
  DrillPath path{name, places_mm.front(), places_mm.back(), count > 2 ? steerable_head() : bit};
  path.via_mm.assign(places_mm.begin() + 1, places_mm.end() - 1);
  if (markup.has("spinaltap")) {
    const JsonObject ours(markup.at("spinaltap"), file);
    path.bit = read_bit(ours.at("bit"), file);
    if (ours.has("screw")) path.screw = read_screw(ours.at("screw"), file);
    if (ours.has("bone")) path.bone = read_bone_identity(ours.at("bone"), file);
  }
  return path;
}

}  // namespace

namespace detail {

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

}  // namespace detail

Json markups_of(const std::vector<DrillPath>& paths) {
  Json file{{"@schema", kSchema}, {"markups", Json::array()}};
  for (const DrillPath& path : paths) {
    Json ours{{"bit", to_json(path.bit)}};
    if (path.screw) ours["screw"] = to_json(*path.screw);
    if (!path.bone.is_empty()) ours["bone"] = to_json(path.bone);
    Json points = Json::array();
    points.push_back(control_point(1, "entry", path.entry_mm));
    int number = 1;
    for (const Vec3& via_mm : path.via_mm) {
      ++number;
      points.push_back(control_point(number, ("via " + std::to_string(number - 1)).c_str(), via_mm));
    }
    points.push_back(control_point(++number, "target", path.target_mm));
    file["markups"].push_back({{"type", path.is_curved() ? "Curve" : "Line"},
                               {"name", path.name},
                               {"coordinateSystem", "LPS"},
                               {"coordinateUnits", "mm"},
                               {"locked", false},
                               {"fixedNumberOfControlPoints", false},
                               {"labelFormat", "%N-%d"},
                               {"lastUsedControlPointNumber", number},
                               {"controlPoints", points},
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
    const bool is_curve = markup.text("type") == "Curve";
    if (!is_curve && markup.text("type") != "Line") continue;
    const bool is_named = markup.has("name") && markup.at("name").is_string() && !markup.text("name").empty();
    paths.push_back(path_of_markup(
        item, is_curve,
        is_named ? markup.text("name") : (is_curve ? "curve " : "line ") + std::to_string(paths.size() + 1), file,
        bit));
  }
  if (paths.empty())
    fail("expected a line or an open curve from the entry to the target among the markups in ", file.string());
  return paths;
}

}  // namespace spinaltap
