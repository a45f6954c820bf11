#include "core/files/planning_rules_file.h"

#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/files/json_file.h"

namespace spinaltap {
namespace {

constexpr FileFormat kRulesFormat{"spinaltap-planning-rules", "file of planning rules", "see docs/data-files.md"};

}  // namespace

SuggestOptions read_planning_rules(const std::filesystem::path& path) {
  const Json json = read_json(path);
  check_format(json, kRulesFormat, path);
  const JsonObject rules(json, path);
  check_keys(json,
             {"format", "version", "name", "sources", "margin_mm", "min_margin_mm", "front_margin_mm", "widest_share",
              "furthest_share", "max_turn_deg", "lateral_breach_mm", "max_back_out_mm", "weights"},
             path, "a rule of planning");
  SuggestOptions options;
  options.margin_mm = rules.number("margin_mm");
  options.min_margin_mm = rules.number("min_margin_mm");
  options.lateral_breach_mm = rules.number("lateral_breach_mm");
  options.max_back_out_mm = rules.number("max_back_out_mm");
  options.front_margin_mm = rules.number("front_margin_mm");
  options.widest_share = rules.number("widest_share");
  options.furthest_share = rules.number("furthest_share");
  options.max_turn_deg = rules.number("max_turn_deg");
  const JsonObject weights(rules.at("weights"), path);
  check_keys(rules.at("weights"),
             {"length", "diameter", "clearance", "canal", "endplates", "density", "along_axis", "approach", "alike",
              "fixation", "hold"},
             path, "a weight of planning");
  options.weights.length = weights.number("length");
  options.weights.diameter = weights.number("diameter");
  options.weights.clearance = weights.number("clearance");
  options.weights.canal = weights.number("canal");
  options.weights.endplates = weights.number("endplates");
  options.weights.density = weights.number("density");
  options.weights.approach = weights.number("approach");
  options.weights.alike = weights.number("alike");
  options.weights.along_axis = weights.number("along_axis");
  // Named hold once; rules of before this weight: as then, without the term.
  if (weights.has("hold") && weights.has("fixation"))
    fail(path.string(), ": hold is fixation's old name: leave one of them out");
  const char* const fixation = weights.has("hold") ? "hold" : "fixation";
  options.weights.fixation = weights.has(fixation) ? weights.number(fixation) : 0.0;
  return options;
}

}  // namespace spinaltap
