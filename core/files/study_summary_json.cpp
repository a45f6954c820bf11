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

}  // namespace

Json to_json(const StudySummary& summary) {
  Json grades = Json::object();
  for (std::size_t n = 0; n < summary.grades.size(); ++n) {
    grades[std::string(1, static_cast<char>('A' + n))] = json_of(summary.grades[n]);
  }
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
  return {{"format", "spinaltap-study-summary"},
          {"version", kFormatVersion},
          {"runs", summary.runs},
          {"interval", "Wilson, 95 %"},
          {"breach", json_of(summary.breach)},
          {"outer_breach", json_of(summary.outer)},
          {"canal_breach", json_of(summary.canal)},
          {"grades", std::move(grades)},
          {"contact", json_of(summary.contact)},
          {"breakthrough", json_of(summary.breakthrough)},
          {"stopped", json_of(summary.stopped)},
          {"gave_up", json_of(summary.gave_up)},
          {"outside_volume", json_of(summary.outside_volume)},
          {"events_lost", summary.events_lost},
          {"distributions", std::move(spreads)},
          {"breach_by_factor", std::move(factors)}};
}

}  // namespace spinaltap
