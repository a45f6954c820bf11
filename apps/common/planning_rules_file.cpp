#include "apps/common/planning_rules_file.h"

#include <algorithm>
#include <initializer_list>
#include <string_view>

#include "apps/common/json_file.h"
#include "core/base/error.h"

namespace spinaltap {
namespace {

/// A key that nobody reads is likely a slip of the pen.
void check_keys(const Json& json, std::initializer_list<std::string_view> known, const std::filesystem::path& path) {
  for (const auto& item : json.items()) {
    if (std::find(known.begin(), known.end(), item.key()) == known.end()) {
      fail("\"", item.key(), "\" in ", path.string(), " is no rule of planning");
    }
  }
}

}  // namespace

SuggestOptions read_planning_rules(const std::filesystem::path& path) {
  const Json json = read_json(path);
  const JsonObject rules(json, path);
  check_keys(
      json,
      {"name", "sources", "margin_mm", "front_margin_mm", "widest_share", "furthest_share", "most_turn_deg", "weights"},
      path);
  SuggestOptions options;
  options.margin_mm = rules.number("margin_mm");
  options.front_margin_mm = rules.number("front_margin_mm");
  options.widest_share = rules.number("widest_share");
  options.furthest_share = rules.number("furthest_share");
  options.most_turn_deg = rules.number("most_turn_deg");
  const JsonObject weights(rules.at("weights"), path);
  check_keys(rules.at("weights"), {"length", "diameter", "clearance", "canal", "endplates", "density", "along_axis"},
             path);
  options.weights.length = weights.number("length");
  options.weights.diameter = weights.number("diameter");
  options.weights.clearance = weights.number("clearance");
  options.weights.canal = weights.number("canal");
  options.weights.endplates = weights.number("endplates");
  options.weights.density = weights.number("density");
  options.weights.along_axis = weights.number("along_axis");
  return options;
}

}  // namespace spinaltap
