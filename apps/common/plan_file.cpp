#include "apps/common/plan_file.h"

#include "apps/common/bit_shapes.h"
#include "apps/common/json_file.h"
#include "core/base/error.h"

namespace spinaltap {
namespace {

constexpr const char* kFormat = "spinaltap-plan";
constexpr int kVersion = 1;

Json to_json(const DrillBit& bit) {
  Json json{{"diameter_mm", bit.diameter_mm}, {"length_mm", bit.length_mm}, {"tip_length_mm", bit.tip_length_mm}};
  // A plain drill stays what programs that know no other shape can read.
  if (bit.shape != BitShape::drill) json["shape"] = name_of(bit.shape);
  if (bit.tip_diameter_mm != 0.0) json["tip_diameter_mm"] = bit.tip_diameter_mm;
  if (bit.shank_diameter_mm != 0.0) json["shank_diameter_mm"] = bit.shank_diameter_mm;
  return json;
}

DrillBit read_bit(const JsonObject& json, const std::filesystem::path& path) {
  DrillBit bit{json.number("diameter_mm"), json.number("length_mm"), json.number("tip_length_mm")};
  if (json.has("shape")) {
    const std::string name = json.text("shape");
    const auto shape = bit_shapes().find(name);
    if (shape == bit_shapes().end()) {
      fail("expected the bit's shape to be drill, round-burr, conical-burr or tapered-screw in ", path.string(),
           ", found \"", name, "\"");
    }
    bit.shape = shape->second;
  }
  if (json.has("tip_diameter_mm")) bit.tip_diameter_mm = json.number("tip_diameter_mm");
  if (json.has("shank_diameter_mm")) bit.shank_diameter_mm = json.number("shank_diameter_mm");
  return bit;
}

}  // namespace

void write_plan(const std::vector<DrillPath>& paths, const std::filesystem::path& path) {
  Json plan{{"format", kFormat}, {"version", kVersion}, {"frame", "LPS"}, {"unit", "mm"}, {"paths", Json::array()}};
  for (const DrillPath& drill_path : paths) {
    plan["paths"].push_back({{"name", drill_path.name},
                             {"entry", to_json(drill_path.entry_mm)},
                             {"target", to_json(drill_path.target_mm)},
                             {"bit", to_json(drill_path.bit)}});
  }
  write_json(plan, path);
}

std::vector<DrillPath> read_plan(const std::filesystem::path& path) {
  const Json json = read_json(path);
  const JsonObject plan(json, path);
  if (plan.text("format") != kFormat || plan.number("version") != kVersion || plan.text("frame") != "LPS" ||
      plan.text("unit") != "mm") {
    fail("expected a ", kFormat, " of version ", kVersion, " in the frame LPS and the unit mm in ", path.string());
  }
  const Json& list = plan.at("paths");
  if (!list.is_array() || list.empty()) fail("expected one path or more in ", path.string(), ", found none");
  std::vector<DrillPath> paths;
  for (const Json& item : list) {
    const JsonObject object(item, path);
    DrillPath drill_path;
    drill_path.name = object.text("name");
    drill_path.entry_mm = object.vector("entry");
    drill_path.target_mm = object.vector("target");
    drill_path.bit = read_bit(JsonObject(object.at("bit"), path), path);
    try {
      check_path(drill_path);
    } catch (const Error& error) {
      fail(path.string(), ": path \"", drill_path.name, "\": ", error.what());
    }
    paths.push_back(drill_path);
  }
  return paths;
}

const DrillPath& choose_path(const std::vector<DrillPath>& paths, const std::string& name) {
  std::string names;
  for (const DrillPath& path : paths) {
    if (name.empty() || path.name == name) return path;
    names += names.empty() ? path.name : ", " + path.name;
  }
  fail("expected the name of a path in the plan, found \"", name, "\"; it has: ", names);
}

}  // namespace spinaltap
