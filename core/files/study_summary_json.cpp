#include "core/files/study_summary_json.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

namespace spinaltap {
namespace {

Json json_of(const StudyShare& share) {
  return {{"runs", share.runs},
          {"count", share.count},
          {"probability", share.probability()},
          {"low", share.interval.low},
          {"high", share.interval.high}};
}

Json json_of(const StudySpread& spread) {
  Json json{{"runs", spread.runs}, {"mean", spread.mean}};
  for (std::size_t n = 0; n < spread.quantiles.size(); ++n) {
    json["p" + std::to_string(std::lround(100.0 * StudySpread::kShares[n]))] = spread.quantiles[n];
  }
  return json;
}

Json json_of(const std::array<StudyShare, 5>& grades) {
  Json json = Json::object();
  for (std::size_t n = 0; n < grades.size(); ++n) {
    json[std::string(1, static_cast<char>('A' + n))] = json_of(grades[n]);
  }
  return json;
}

Json json_of(const StudyScrews& screws) {
  Json json{{"of", screws.what},
            {"runs", screws.runs},
            {"patients", screws.patients},
            {"grades", json_of(screws.grades)},
            {"a_or_b", json_of(screws.acceptable)},
            {"canal_breach", json_of(screws.canal)},
            {"anterior_breach", json_of(screws.anterior)}};
  if (screws.neighbour.runs > 0) json["neighbour_breach"] = json_of(screws.neighbour);
  return json;
}

Json json_of(const StudyTolerance& tolerance) {
  Json levels = Json::array();
  for (std::size_t n = 0; n < tolerance.a.size(); ++n) {
    levels.push_back({{"scale", tolerance.scales[n]}, {"a", json_of(tolerance.a[n])}});
  }
  Json up_to = nullptr;
  if (tolerance.up_to) up_to = std::isinf(*tolerance.up_to) ? Json("beyond") : Json(*tolerance.up_to);
  Json factors = Json::array();
  for (const StudyFactor factor : tolerance.factors) factors.push_back(name_of(factor));
  return {{"factors", std::move(factors)}, {"levels", std::move(levels)}, {"scale_for_95_percent_a", up_to}};
}

Json json_of(const Interval& interval) { return {number_or_null(interval.low), number_or_null(interval.high)}; }

Json json_of(const StudySensitivity& sensitivity, const std::vector<std::string>& inputs) {
  Json indices = Json::object();
  for (std::size_t n = 0; n < inputs.size(); ++n) {
    const SobolIndex& index = sensitivity.indices.groups.at(n);
    indices[inputs[n]] = {{"first_order", number_or_null(index.first_order)},
                          {"first_order_interval", json_of(index.first_order_interval)},
                          {"total", number_or_null(index.total)},
                          {"total_interval", json_of(index.total_interval)}};
  }
  return {{"of", sensitivity.result},
          {"blocks", sensitivity.indices.blocks},
          {"mean", sensitivity.indices.mean},
          {"variance", sensitivity.indices.variance},
          {"inputs", std::move(indices)}};
}

}  // namespace

Json to_json(const StudySummary& summary) {
  Json spreads = Json::object();
  for (const StudySpread& spread : summary.spreads) {
    spreads[std::string(name_of(spread.column))] = json_of(spread);
  }
  Json factors = Json::object();
  for (const StudySummary::ByFactor& by : summary.factors) {
    Json bins = Json::array();
    for (const StudyBin& bin : by.bins) {
      bins.push_back({{"low", bin.low},
                      {"high", bin.high},
                      {"mean", bin.middle},
                      {"breach", json_of(bin.breach)},
                      {"canal", json_of(bin.canal)}});
    }
    factors[std::string(name_of(by.factor))] = std::move(bins);
  }
  Json json{{"format", "spinaltap-study-summary"},
            {"version", kFormatVersion},
            {"runs", summary.runs},
            {"interval", "Wilson, 95 %"}};
  if (summary.has_drilled) {
    json.update(Json{{"breach", json_of(summary.breach)},
                     {"outer_breach", json_of(summary.outer)},
                     {"canal_breach", json_of(summary.canal)},
                     {"grades", json_of(summary.grades)},
                     {"contact", json_of(summary.contact)},
                     {"breakthrough", json_of(summary.breakthrough)},
                     {"stopped", json_of(summary.stopped)},
                     {"gave_up", json_of(summary.gave_up)},
                     {"outside_volume", json_of(summary.outside_volume)},
                     {"events_lost", summary.events_lost}});
  }
  json["distributions"] = std::move(spreads);
  json["breach_by_factor"] = std::move(factors);
  if (!summary.screws.empty()) {
    json["screw_interval"] = "for patients like these, 95 %";
    json["screws"] = Json::array();
    for (const StudyScrews& screws : summary.screws) json["screws"].push_back(json_of(screws));
  }
  for (const StudyTolerance& tolerance : summary.tolerances) json["tolerances"].push_back(json_of(tolerance));
  for (const StudySensitivity& one : summary.sensitivities) {
    json["sensitivities"].push_back(json_of(one, summary.inputs));
  }
  return json;
}

}  // namespace spinaltap
