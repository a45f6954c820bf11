#include "core/study/study_summary.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

namespace spinaltap {
namespace {

/// Columns whose distribution is told.
constexpr std::array<StudyColumn, 12> kSpreads{
    StudyColumn::max_thrust_n,           StudyColumn::max_torque_n_mm,   StudyColumn::plunge_depth_mm,
    StudyColumn::breach_outer_mm,        StudyColumn::breach_canal_mm,   StudyColumn::min_clearance_outer_mm,
    StudyColumn::min_clearance_canal_mm, StudyColumn::depth_mm,          StudyColumn::time_s,
    StudyColumn::screw_pullout_n,        StudyColumn::screw_torque_n_mm, StudyColumn::max_temperature_c};
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

StudyBin bin_of(const Pointers& rows, std::size_t begin, std::size_t end, StudyFactor factor) {
  StudyBin bin{(*rows[begin])[factor], (*rows[end - 1])[factor]};
  std::size_t breaches = 0;
  std::size_t canals = 0;
  for (std::size_t n = begin; n < end; ++n) {
    bin.middle += (*rows[n])[factor] / static_cast<double>(end - begin);
    if ((*rows[n])[StudyColumn::breach] > 0.0) ++breaches;
    if ((*rows[n])[StudyColumn::breach_canal_mm] > 0.0) ++canals;
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

}  // namespace

StudyShare study_share(std::size_t count, std::size_t runs) { return {runs, count, wilson_interval(count, runs)}; }

StudySummary summarise_study(const std::vector<StudyRow>& rows, const StudyDesign& design) {
  StudySummary summary;
  summary.runs = rows.size();
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
  for (const StudyRow& row : rows) summary.events_lost += static_cast<std::size_t>(row[StudyColumn::events_lost]);
  for (const StudyColumn column : kSpreads) summary.spreads.push_back(spread_of(rows, column));
  for (const FactorDistribution& distribution : design.distributions) {
    // One level differs from nothing.
    if (distribution.kind == FactorDistribution::Kind::levels && distribution.levels.size() == 1) continue;
    summary.factors.push_back(by_factor(rows, distribution));
  }
  return summary;
}

}  // namespace spinaltap
