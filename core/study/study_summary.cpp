#include "core/study/study_summary.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "core/base/lerp.h"
#include "core/ct/level.h"

namespace spinaltap {
namespace {

/// Columns whose distribution is told.
constexpr std::array<StudyColumn, 16> kSpreads{
    StudyColumn::max_thrust_n,           StudyColumn::max_torque_n_mm,   StudyColumn::plunge_depth_mm,
    StudyColumn::breach_outer_mm,        StudyColumn::breach_canal_mm,   StudyColumn::min_clearance_outer_mm,
    StudyColumn::min_clearance_canal_mm, StudyColumn::depth_mm,          StudyColumn::time_s,
    StudyColumn::screw_pullout_n,        StudyColumn::screw_torque_n_mm, StudyColumn::max_temperature_c,
    StudyColumn::off_entry_mm,           StudyColumn::off_target_mm,     StudyColumn::off_angle_deg,
    StudyColumn::screw_breach_mm};
constexpr std::size_t kBins = 10;  ///< of a factor that is drawn

using Rows = std::vector<StudyRow>;
using Pointers = std::vector<const StudyRow*>;

StudyShare share_of(const Rows& rows, const std::function<bool(const StudyRow&)>& is_met) {
  return study_share(static_cast<std::size_t>(std::count_if(rows.begin(), rows.end(), is_met)), rows.size());
}

StudySpread spread_of(const Rows& rows, StudyColumn column) {
  std::vector<double> values;
  for (const StudyRow& row : rows) {
    if (std::isfinite(row[column])) values.push_back(row[column]);
  }
  std::sort(values.begin(), values.end());
  StudySpread spread{column, values.size()};
  // Ascending order, so that the sum is the same whatever the runs' order was.
  for (const double value : values) spread.mean += value / static_cast<double>(values.size());
  if (values.empty()) spread.mean = std::nan("");
  std::transform(StudySpread::kShares.begin(), StudySpread::kShares.end(), spread.quantiles.begin(),
                 [&](double share) { return quantile(values, share); });
  return spread;
}

bool has_drilled(const StudyRow& row) { return !std::isnan(row[StudyColumn::breach]); }

StudyBin bin_of(const Pointers& rows, std::size_t begin, std::size_t end, StudyFactor factor) {
  StudyBin bin{(*rows[begin])[factor], (*rows[end - 1])[factor]};
  std::size_t breaches = 0;
  std::size_t canals = 0;
  for (std::size_t n = begin; n < end; ++n) {
    bin.middle += (*rows[n])[factor] / static_cast<double>(end - begin);
    const StudyRow& row = *rows[n];
    const bool drilled = has_drilled(row);
    if (row[drilled ? StudyColumn::breach : StudyColumn::screw_breach_mm] > 0.0) ++breaches;
    if (row[drilled ? StudyColumn::breach_canal_mm : StudyColumn::screw_canal_mm] > 0.0) ++canals;
  }
  if (bin.low == bin.high) bin.middle = bin.low;  // and not the sum's rounding
  bin.breach = study_share(breaches, end - begin);
  bin.canal = study_share(canals, end - begin);
  return bin;
}

/// One bin a level, or bins of equally many runs. A run without the factor, as in a table that was changed, is in none.
StudySummary::ByFactor by_factor(const Rows& rows, const FactorDistribution& distribution) {
  StudySummary::ByFactor result{distribution.factor, {}};
  Pointers sorted;
  for (const StudyRow& row : rows) {
    if (!std::isnan(row[distribution.factor])) sorted.push_back(&row);
  }
  std::stable_sort(sorted.begin(), sorted.end(), [&](const StudyRow* a, const StudyRow* b) {
    return (*a)[distribution.factor] < (*b)[distribution.factor];
  });
  if (distribution.kind == FactorDistribution::Kind::levels) {
    for (std::size_t begin = 0, end = 0; begin < sorted.size(); begin = end) {
      const double level = (*sorted[begin])[distribution.factor];
      while (end < sorted.size() && (*sorted[end])[distribution.factor] == level) ++end;
      result.bins.push_back(bin_of(sorted, begin, end, distribution.factor));
    }
  } else {
    const std::size_t bins = std::min(kBins, sorted.size());
    for (std::size_t n = 0; n < bins; ++n) {
      result.bins.push_back(
          bin_of(sorted, n * sorted.size() / bins, (n + 1) * sorted.size() / bins, distribution.factor));
    }
  }
  return result;
}

/// The share of screws that `is_met`, for patients like these.
template <class IsMet>
StudyShare share_of_screws(const Pointers& rows, const IsMet& is_met) {
  ScrewCount count;
  for (const StudyRow* row : rows) count.add(*row, is_met(*row));
  return count.share();
}

StudyScrews screws_among(const Pointers& rows, std::string what) {
  StudyScrews screws;
  screws.what = std::move(what);
  screws.runs = rows.size();
  std::set<double> patients;
  Pointers with_neighbours;
  for (const StudyRow* row : rows) {
    patients.insert((*row)[StudyColumn::patient]);
    if (!std::isnan((*row)[StudyColumn::screw_neighbour_mm])) with_neighbours.push_back(row);
  }
  screws.patients = patients.size();
  for (std::size_t n = 0; n < screws.grades.size(); ++n) {
    screws.grades[n] = share_of_screws(
        rows, [n](const StudyRow& row) { return row[StudyColumn::screw_grade] == static_cast<double>(n); });
  }
  const auto above_0 = [](StudyColumn column) { return [column](const StudyRow& row) { return row[column] > 0.0; }; };
  screws.acceptable = share_of_screws(rows, [](const StudyRow& row) { return row[StudyColumn::screw_grade] <= 1.0; });
  screws.canal = share_of_screws(rows, above_0(StudyColumn::screw_canal_mm));
  screws.anterior = share_of_screws(rows, above_0(StudyColumn::screw_anterior_mm));
  if (!with_neighbours.empty()) {
    screws.neighbour = share_of_screws(with_neighbours, above_0(StudyColumn::screw_neighbour_mm));
  }
  return screws;
}

std::string name_of_group(StudyColumn column, double value) {
  if (column == StudyColumn::patient) return "patient " + std::to_string(static_cast<std::size_t>(value));
  if (column == StudyColumn::level) return level_name(static_cast<Level>(static_cast<std::size_t>(value)));
  return value == 0.0 ? "left" : "right";
}

/// Graded screws that have something in common: of all, then by patient, level and side where there are several.
struct ScrewGroup {
  std::string what;
  Pointers rows;
  bool is_of_patient = false;
};
std::vector<ScrewGroup> screw_groups(const Rows& rows) {
  ScrewGroup all{"all", {}};
  for (const StudyRow& row : rows) {
    if (!std::isnan(row[StudyColumn::screw_grade])) all.rows.push_back(&row);
  }
  if (all.rows.empty()) return {};
  std::vector<ScrewGroup> groups{std::move(all)};
  for (const StudyColumn column : {StudyColumn::patient, StudyColumn::level, StudyColumn::side}) {
    std::map<double, Pointers> of_value;
    for (const StudyRow* row : groups.front().rows) {
      if (!std::isnan((*row)[column])) of_value[(*row)[column]].push_back(row);
    }
    if (of_value.size() < 2) continue;
    for (auto& [value, of] : of_value) {
      groups.push_back({name_of_group(column, value), std::move(of), column == StudyColumn::patient});
    }
  }
  return groups;
}

void add_screws(const Rows& rows, StudySummary& summary) {
  for (const ScrewGroup& group : screw_groups(rows)) {
    summary.screws.push_back(screws_among(group.rows, group.what));
    if (group.is_of_patient) continue;  // too few runs for a map
    for (const OffPlan off : {OffPlan::entry, OffPlan::direction}) {
      StudyMap map = study_map(group.rows, group.what, off);
      if (!map.cells.empty()) summary.maps.push_back(std::move(map));
    }
  }
}

constexpr std::array<StudyFactor, 3> kErrorScales{StudyFactor::entry_error_scale, StudyFactor::direction_error_scale,
                                                  StudyFactor::registration_scale};

/// Of factors that go together: of the runs in which they are one scale, and the other scales 1; where there are none
/// such, whatever the others are.
StudyTolerance tolerance_of(const Rows& rows, std::vector<StudyFactor> factors) {
  StudyTolerance tolerance;
  tolerance.factors = std::move(factors);
  const auto go_together = [&](const StudyRow& row) {
    return std::all_of(tolerance.factors.begin(), tolerance.factors.end(),
                       [&](StudyFactor factor) { return row[factor] == row[tolerance.factors.front()]; });
  };
  const auto has_others_at_1 = [&](const StudyRow& row) {
    return std::all_of(kErrorScales.begin(), kErrorScales.end(), [&](StudyFactor other) {
      const bool goes_along =
          std::find(tolerance.factors.begin(), tolerance.factors.end(), other) != tolerance.factors.end();
      return goes_along || std::isnan(row[other]) || row[other] == 1.0;
    });
  };
  const bool are_there = std::any_of(rows.begin(), rows.end(), has_others_at_1);
  std::map<double, Pointers> by_scale;
  for (const StudyRow& row : rows) {
    if (std::isnan(row[StudyColumn::screw_grade]) || !go_together(row)) continue;
    if (are_there && !has_others_at_1(row)) continue;
    by_scale[row[tolerance.factors.front()]].push_back(&row);
  }
  for (const auto& [scale, of] : by_scale) {
    tolerance.scales.push_back(scale);
    tolerance.a.push_back(
        share_of_screws(of, [](const StudyRow& row) { return row[StudyColumn::screw_grade] == 0.0; }));
  }
  if (tolerance.a.empty() || tolerance.a.front().probability() < StudyTolerance::kWanted) return tolerance;
  tolerance.up_to = std::numeric_limits<double>::infinity();
  for (std::size_t n = 1; n < tolerance.a.size(); ++n) {
    const double above = tolerance.a[n - 1].probability(), below = tolerance.a[n].probability();
    if (below >= StudyTolerance::kWanted) continue;
    tolerance.up_to =
        lerp(tolerance.scales[n - 1], tolerance.scales[n], (above - StudyTolerance::kWanted) / (above - below));
    break;
  }
  return tolerance;
}

std::vector<StudyTolerance> tolerances_of(const Rows& rows, const StudyDesign& design) {
  std::vector<StudyFactor> scales;
  for (const FactorDistribution& distribution : design.distributions) {
    const bool has_levels = distribution.kind == FactorDistribution::Kind::levels && distribution.levels.size() > 1;
    const bool is_scale =
        std::find(kErrorScales.begin(), kErrorScales.end(), distribution.factor) != kErrorScales.end();
    if (has_levels && is_scale) scales.push_back(distribution.factor);
  }
  std::vector<StudyTolerance> tolerances;
  tolerances.reserve(scales.size() + 1);
  for (const StudyFactor factor : scales) tolerances.push_back(tolerance_of(rows, {factor}));
  if (scales.size() > 1) {
    StudyTolerance together = tolerance_of(rows, scales);
    if (!together.scales.empty()) tolerances.push_back(std::move(together));  // none where no level is common to all
  }
  return tolerances;
}

/// Of those results that every run has.
std::vector<StudySensitivity> sensitivities_of(const Rows& rows, const StudyRuns& runs) {
  std::vector<StudySensitivity> sensitivities;
  const std::size_t inputs = runs.inputs().size();
  if (inputs == 0 || rows.size() != runs.count() || runs.design().runs < kMinSobolBlocks) return sensitivities;
  const auto add = [&](std::string_view name, const auto& value) {
    std::vector<double> outputs;
    for (const StudyRow& row : rows) outputs.push_back(value(row));
    const bool is_whole = std::all_of(outputs.begin(), outputs.end(), [](double v) { return std::isfinite(v); });
    if (is_whole) sensitivities.push_back({std::string(name), sobol_indices(outputs, inputs)});
  };
  for (const StudyColumn column :
       {StudyColumn::screw_breach_mm, StudyColumn::breach_outer_mm, StudyColumn::breach_canal_mm,
        StudyColumn::max_thrust_n, StudyColumn::screw_pullout_n, StudyColumn::max_temperature_c}) {
    add(name_of(column), [column](const StudyRow& row) { return row[column]; });
  }
  for (const auto& [name, grade] : {std::pair{"screw_beyond_a", 0.0}, std::pair{"screw_beyond_b", 1.0}}) {
    add(name, [limit = grade](const StudyRow& row) {
      const double is = row[StudyColumn::screw_grade];
      return std::isnan(is) ? is : is > limit ? 1.0 : 0.0;
    });
  }
  return sensitivities;
}

}  // namespace

StudySummary summarise_study(const std::vector<StudyRow>& rows, const StudyRuns& runs) {
  StudySummary summary;
  summary.runs = rows.size();
  summary.has_drilled = std::any_of(rows.begin(), rows.end(), has_drilled);
  const auto above_0 = [&](StudyColumn column) {
    return share_of(rows, [column](const StudyRow& row) { return row[column] > 0.0; });
  };
  const auto has = [&](StudyColumn column) {
    return share_of(rows, [column](const StudyRow& row) { return !std::isnan(row[column]); });
  };
  summary.breach = above_0(StudyColumn::breach);
  summary.outer = above_0(StudyColumn::breach_outer_mm);
  summary.canal = above_0(StudyColumn::breach_canal_mm);
  for (std::size_t grade = 0; grade < summary.grades.size(); ++grade) {
    summary.grades[grade] =
        share_of(rows, [grade](const StudyRow& row) { return row[StudyColumn::grade] == static_cast<double>(grade); });
  }
  summary.contact = above_0(StudyColumn::contact);
  summary.breakthrough = has(StudyColumn::breakthrough_mm);
  summary.stopped = has(StudyColumn::stop_mm);
  summary.gave_up = has(StudyColumn::gave_up_mm);
  summary.outside_volume = above_0(StudyColumn::outside_volume_mm);
  for (const StudyRow& row : rows) {
    if (row[StudyColumn::events_lost] > 0.0)
      summary.events_lost += static_cast<std::size_t>(row[StudyColumn::events_lost]);
  }
  for (const StudyColumn column : kSpreads) summary.spreads.push_back(spread_of(rows, column));
  for (const FactorDistribution& distribution : runs.design().distributions) {
    // One level differs from nothing.
    if (distribution.kind == FactorDistribution::Kind::levels && distribution.levels.size() == 1) continue;
    summary.factors.push_back(by_factor(rows, distribution));
  }
  summary.tolerances = tolerances_of(rows, runs.design());
  add_screws(rows, summary);
  summary.inputs = runs.inputs();
  summary.sensitivities = sensitivities_of(rows, runs);
  return summary;
}

}  // namespace spinaltap
