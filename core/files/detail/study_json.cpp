#include "core/files/detail/study_json.h"

#include <nlohmann/json.hpp>
#include <string>

#include "core/base/error.h"
#include "core/base/text_fields.h"
#include "core/files/detail/material_json.h"

namespace spinaltap {
namespace {

double positive_or(const JsonObject& object, const char* key, double fallback, const std::filesystem::path& file) {
  const double number = object.number_or(key, fallback);
  if (!(number > 0.0)) fail("expected a number above 0 for \"", key, "\" in ", file.string(), ", found ", number);
  return number;
}

double not_negative_or(const JsonObject& object, const char* key, double fallback, const std::filesystem::path& file) {
  const double number = object.number_or(key, fallback);
  if (!(number >= 0.0)) fail("expected a number of 0 or more for \"", key, "\" in ", file.string(), ", found ", number);
  return number;
}

StudyFactor factor_called(const std::string& name, const std::filesystem::path& file) {
  std::string known;
  for (std::size_t n = 0; n < kStudyFactors; ++n) {
    const auto factor = static_cast<StudyFactor>(n);
    if (name_of(factor) == name) return factor;
    known += (known.empty() ? "" : ", ") + std::string(name_of(factor));
  }
  fail("expected the name of a factor in ", file.string(), ", found ", in_quotes(name), "; there are: ", known);
}

/// Its numbers, or "material": those of the material's thrust.
ForceSpread spread_of(const Json& json, const Material& material, const std::filesystem::path& file) {
  if (json == "material") {
    if (!(material.thrust_spread.log_scale > 0.0)) {
      fail("expected a material with a \"thrust_spread\" for \"spread\": \"material\" in ", file.string(),
           ", found one without");
    }
    return material.thrust_spread;
  }
  return read_force_spread(json, file);
}

FactorDistribution read_distribution(StudyFactor factor, const Json& json, const Material& material,
                                     const std::filesystem::path& file) {
  const std::string name(name_of(factor));
  const auto reject = [&](const std::string& found) {
    fail("expected one of \"levels\", \"normal\", \"uniform\" and \"spread\" for \"", name, "\" in ", file.string(),
         ", found ", found);
  };
  const bool has_per = json.is_object() && json.contains("per");
  if (!json.is_object() || json.size() != (has_per ? 2 : 1)) reject(shown_value(json));
  const JsonObject object(json, file);
  FactorDistribution distribution{factor};
  distribution.per = read_drawn_per(object, file);
  if (object.has("levels")) {
    const Json& levels = object.at("levels");
    if (!levels.is_array()) fail("expected a list for \"levels\" of \"", name, "\" in ", file.string());
    for (const Json& level : levels) {
      if (!level.is_number()) {
        fail("expected numbers for \"levels\" of \"", name, "\" in ", file.string(), ", found ", shown_value(level));
      }
      distribution.levels.push_back(level.get<double>());
    }
  } else if (object.has("normal")) {
    check_keys(object.at("normal"), {"mean", "deviation"}, file, "\"mean\" and \"deviation\"");
    const JsonObject normal(object.at("normal"), file);
    distribution.kind = FactorDistribution::Kind::normal;
    distribution.a = normal.number("mean");
    distribution.b = normal.number("deviation");
  } else if (object.has("uniform")) {
    check_keys(object.at("uniform"), {"low", "high"}, file, "\"low\" and \"high\"");
    const JsonObject uniform(object.at("uniform"), file);
    distribution.kind = FactorDistribution::Kind::uniform;
    distribution.a = uniform.number("low");
    distribution.b = uniform.number("high");
  } else if (object.has("spread")) {
    distribution.kind = FactorDistribution::Kind::spread;
    const ForceSpread spread = spread_of(object.at("spread"), material, file);
    distribution.a = spread.median;
    distribution.b = spread.log_scale;
    distribution.degrees = static_cast<int>(spread.degrees);
  } else {
    reject(in_quotes(json.begin().key()));
  }
  return distribution;
}

Json law_of(const FactorDistribution& distribution) {
  switch (distribution.kind) {
    case FactorDistribution::Kind::normal:
      return {{"normal", {{"mean", distribution.a}, {"deviation", distribution.b}}}};
    case FactorDistribution::Kind::uniform:
      return {{"uniform", {{"low", distribution.a}, {"high", distribution.b}}}};
    case FactorDistribution::Kind::spread:
      return {
          {"spread", to_json(ForceSpread{distribution.a, distribution.b, static_cast<double>(distribution.degrees)})}};
    case FactorDistribution::Kind::levels:
      break;
  }
  return {{"levels", distribution.levels}};
}

Json json_of(const FactorDistribution& distribution) {
  Json json = law_of(distribution);
  if (distribution.per != DrawnPer::run) json["per"] = name_of(distribution.per);
  return json;
}

/// Which of an enumeration's names a key has; the first where there is none.
template <class Enum>
Enum choice_of(const JsonObject& object, const char* key, int count, const std::filesystem::path& file) {
  if (!object.has(key)) return Enum{};
  const std::string found = object.text(key);
  std::string known;
  for (int n = 0; n < count; ++n) {
    const auto choice = static_cast<Enum>(n);
    if (name_of(choice) == found) return choice;
    known += (n == 0 ? "\"" : n + 1 < count ? ", \"" : " or \"") + std::string(name_of(choice)) + "\"";
  }
  fail("expected ", known, " for \"", key, "\" in ", file.string(), ", found ", in_quotes(found));
}

}  // namespace

StudyKind read_study_kind(const JsonObject& object, const std::filesystem::path& file) {
  return choice_of<StudyKind>(object, "kind", 2, file);
}

DrawnPer read_drawn_per(const JsonObject& object, const std::filesystem::path& file) {
  return choice_of<DrawnPer>(object, "per", 3, file);
}

std::size_t checked_patient(std::uint64_t number, const std::filesystem::path& file) {
  if (number < 1 || number > StudyRuns::kMaxRuns) {
    fail("expected a \"patient\" from 1 to ", StudyRuns::kMaxRuns, " in ", file.string(), ", found ", number);
  }
  return static_cast<std::size_t>(number - 1);
}

Json to_json(const StudyOperator& tool_operator) {
  Json json{{"kind", tool_operator.kind == StudyOperator::Kind::feed ? "feed" : "push"}};
  if (tool_operator.kind == StudyOperator::Kind::feed) {
    json["feed_mm_s"] = tool_operator.feed_mm_s;
    json["step_mm"] = tool_operator.step_mm;
  } else {
    json["push_n"] = tool_operator.push_n;
    json["rate_hz"] = tool_operator.rate_hz;
    json["reaction_s"] = tool_operator.reaction_s;
    json["max_push_n"] = tool_operator.max_push_n;
    json["noticed_share"] = tool_operator.noticed_share;
  }
  json["tremor_mm"] = tool_operator.tremor_mm;
  return json;
}

StudyOperator read_study_operator(const Json& json, const std::filesystem::path& file) {
  const JsonObject object(json, file);
  StudyOperator tool_operator;
  const std::string kind = object.text("kind");
  if (kind == "feed") {
    check_keys(json, {"kind", "feed_mm_s", "step_mm", "tremor_mm"}, file, "a key of an operator that feeds");
    tool_operator.feed_mm_s = positive_or(object, "feed_mm_s", tool_operator.feed_mm_s, file);
    tool_operator.step_mm = positive_or(object, "step_mm", tool_operator.step_mm, file);
  } else if (kind == "push") {
    check_keys(json, {"kind", "push_n", "rate_hz", "max_push_n", "reaction_s", "noticed_share", "tremor_mm"}, file,
               "a key of an operator that pushes");
    tool_operator.kind = StudyOperator::Kind::push;
    tool_operator.push_n = positive_or(object, "push_n", tool_operator.push_n, file);
    tool_operator.rate_hz = positive_or(object, "rate_hz", tool_operator.rate_hz, file);
    tool_operator.reaction_s = not_negative_or(object, "reaction_s", tool_operator.reaction_s, file);
    tool_operator.max_push_n = positive_or(object, "max_push_n", tool_operator.max_push_n, file);
    tool_operator.noticed_share = not_negative_or(object, "noticed_share", tool_operator.noticed_share, file);
  } else {
    fail("expected \"feed\" or \"push\" for \"kind\" of \"operator\" in ", file.string(), ", found ", in_quotes(kind));
  }
  tool_operator.tremor_mm = not_negative_or(object, "tremor_mm", tool_operator.tremor_mm, file);
  return tool_operator;
}

Json to_json(const StudyDesign& design) {
  Json factors = Json::object();
  for (const FactorDistribution& distribution : design.distributions)
    factors[std::string(name_of(distribution.factor))] = json_of(distribution);
  return {{"runs", design.runs},
          {"sampling", name_of(design.sampling)},
          {"seed", design.seed},
          {"factors", std::move(factors)}};
}

StudyDesign read_study_design(const Json& json, const std::filesystem::path& file, const Material& material) {
  const JsonObject object(json, file);
  check_keys(json, {"runs", "sampling", "seed", "factors"}, file, kStudyKey);
  StudyDesign design;
  if (object.has("runs")) design.runs = object.whole_number("runs");
  if (object.has("seed")) design.seed = object.whole_number("seed");
  design.sampling = choice_of<StudySampling>(object, "sampling", 3, file);
  if (object.has("factors")) {
    const Json& factors = object.at("factors");
    if (!factors.is_object()) fail("expected an object for \"factors\" in ", file.string());
    for (const auto& item : factors.items()) {
      design.distributions.push_back(read_distribution(factor_called(item.key(), file), item.value(), material, file));
    }
  }
  return design;
}

}  // namespace spinaltap
