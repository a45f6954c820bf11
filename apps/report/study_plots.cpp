#include "apps/report/study_plots.h"

#include <algorithm>
#include <cmath>

#include "apps/report/plot_ticks.h"
#include "apps/report/text.h"

namespace spinaltap {
namespace {

constexpr double kStudyPlotHeight = 260.0;

Plot plot_over(const StudyTitle& x) {
  Plot plot;
  plot.x_label = x.name;
  plot.x_unit = x.unit;
  plot.height = kStudyPlotHeight;
  return plot;
}

}  // namespace

StudyTitle title_of(StudyColumn column) {
  switch (column) {
    case StudyColumn::breach_outer_mm:
      return {"breach of the outer surface", "mm"};
    case StudyColumn::breach_canal_mm:
      return {"breach of the canal", "mm"};
    case StudyColumn::min_clearance_outer_mm:
      return {"min clearance to the outer surface", "mm"};
    case StudyColumn::min_clearance_canal_mm:
      return {"min clearance to the canal", "mm"};
    case StudyColumn::max_thrust_n:
      return {"max thrust", "N"};
    case StudyColumn::max_torque_n_mm:
      return {"max torque", "N·mm"};
    case StudyColumn::plunge_depth_mm:
      return {"plunge depth", "mm"};
    case StudyColumn::depth_mm:
      return {"depth reached", "mm"};
    case StudyColumn::time_s:
      return {"time of drilling", "s"};
    case StudyColumn::screw_pullout_n:
      return {"pull-out strength of the screw", "N"};
    case StudyColumn::screw_torque_n_mm:
      return {"insertion torque of the screw", "N·mm"};
    case StudyColumn::max_temperature_c:
      return {"hottest bone beside the hole", "°C"};
    case StudyColumn::off_entry_mm:
      return {"entry, distance from the plan", "mm"};
    case StudyColumn::off_target_mm:
      return {"tip, distance from the plan", "mm"};
    case StudyColumn::off_angle_deg:
      return {"angle to the plan", "°"};
    case StudyColumn::screw_breach_mm:
      return {"breach of the screw", "mm"};
    default:
      return {std::string(name_of(column)), ""};
  }
}

StudyTitle title_of(StudyFactor factor) {
  switch (factor) {
    case StudyFactor::entry_left_mm:
      return {"entry, error to the left", "mm"};
    case StudyFactor::entry_head_mm:
      return {"entry, error to the head", "mm"};
    case StudyFactor::angle_left_deg:
      return {"angle, error to the left", "°"};
    case StudyFactor::angle_head_deg:
      return {"angle, error to the head", "°"};
    case StudyFactor::bit_diameter_mm:
      return {"diameter of the bit", "mm"};
    case StudyFactor::push_n:
      return {"force of the push", "N"};
    case StudyFactor::feed_mm_s:
      return {"feed", "mm/s"};
    case StudyFactor::tremor_mm:
      return {"tremor", "mm"};
    case StudyFactor::density_scale:
      return {"scale of the bone's density", ""};
    case StudyFactor::force_scale:
      return {"scale of the forces", ""};
    case StudyFactor::entry_error_scale:
      return {"scale of the entry's errors", ""};
    case StudyFactor::direction_error_scale:
      return {"scale of the direction's errors", ""};
    case StudyFactor::registration_scale:
      return {"scale of the registration's errors", ""};
  }
  return {std::string(name_of(factor)), ""};
}

std::string name_of(const StudyTolerance& tolerance) {
  return tolerance.factors.size() == 1 ? title_of(tolerance.factors.front()).name
                                       : "scale of all these errors together";
}

std::string words_of(const StudyTolerance& tolerance) {
  if (!tolerance.up_to) {
    return tolerance.scales.empty() ? "no screw was graded"
                                    : "less even at " + readable_number(tolerance.scales.front(), 2);
  }
  if (std::isinf(*tolerance.up_to)) return "more than " + readable_number(tolerance.scales.back(), 2);
  return readable_number(*tolerance.up_to, 2);
}

Plot tolerance_plot(const StudyTolerance& tolerance) {
  Plot plot = plot_over({name_of(tolerance), ""});
  plot.title = "Screws of grade A over the " + plot.x_label;
  plot.y_label = "share of grade A";
  plot.y_unit = "%";
  PlotSeries series{"", tolerance.scales, {}};
  PlotBand band{"95 % interval, patients like these", tolerance.scales, {}, {}};
  for (const StudyShare& share : tolerance.a) {
    series.y.push_back(100.0 * share.probability());
    band.low.push_back(100.0 * share.interval.low);
    band.high.push_back(100.0 * share.interval.high);
  }
  plot.series = {std::move(series)};
  plot.bands = {std::move(band)};
  if (tolerance.up_to && std::isfinite(*tolerance.up_to)) plot.markers = {{*tolerance.up_to, "95 %"}};
  return plot;
}

Plot breach_plot(const StudySummary::ByFactor& by_factor) {
  Plot plot = plot_over(title_of(by_factor.factor));
  plot.title = "Breach over " + plot.x_label;
  plot.y_label = "probability of a breach";
  plot.y_unit = "%";
  plot.y_from_zero = true;
  PlotSeries any{"any wall", {}, {}};
  PlotSeries canal{"canal", {}, {}};
  PlotBand any_band{"95 % intervals", {}, {}, {}};
  PlotBand canal_band{"", {}, {}, {}};
  const auto add = [](const StudyBin& bin, const StudyShare& share, PlotSeries& series, PlotBand& band) {
    series.x.push_back(bin.middle);
    series.y.push_back(100.0 * share.probability());
    band.x.push_back(bin.middle);
    band.low.push_back(100.0 * share.interval.low);
    band.high.push_back(100.0 * share.interval.high);
  };
  for (const StudyBin& bin : by_factor.bins) {
    add(bin, bin.breach, any, any_band);
    add(bin, bin.canal, canal, canal_band);
  }
  plot.series = {any, canal};
  plot.bands = {any_band, canal_band};
  return plot;
}

Plot histogram(const std::vector<StudyRow>& rows, StudyColumn column) {
  constexpr int kBins = 30;
  Plot plot = plot_over(title_of(column));
  plot.title = "Runs by " + plot.x_label;
  plot.y_label = "runs";
  plot.y_from_zero = true;
  std::vector<double> values;
  for (const StudyRow& row : rows) {
    if (std::isfinite(row[column])) values.push_back(row[column]);
  }
  if (values.empty()) return plot;
  const auto [min, max] = std::minmax_element(values.begin(), values.end());
  const AxisTicks ticks = linear_ticks(*min, *max, kBins);
  const double width = ticks.major[1] - ticks.major[0];
  const auto bins = static_cast<std::size_t>(std::lround((ticks.high - ticks.low) / width));
  std::vector<double> counts(bins, 0.0);
  for (const double value : values) {
    const double place = std::floor((value - ticks.low) / width);
    counts[std::min(bins - 1, static_cast<std::size_t>(std::max(0.0, place)))] += 1.0;
  }
  PlotSeries series{"runs", {ticks.low}, {0.0}, true};
  for (std::size_t n = 0; n < bins; ++n) {
    series.x.push_back(ticks.low + static_cast<double>(n) * width);
    series.y.push_back(counts[n]);
  }
  series.x.insert(series.x.end(), {ticks.high, ticks.high});
  series.y.insert(series.y.end(), {counts.back(), 0.0});
  plot.series = {series};
  return plot;
}

Plot scatter(const std::vector<StudyRow>& rows, StudyFactor across, StudyFactor up, std::size_t max) {
  Plot plot = plot_over(title_of(across));
  const StudyTitle title = title_of(up);
  plot.title = "Breaches by " + plot.x_label + " and " + title.name;
  plot.y_label = title.name;
  plot.y_unit = title.unit;
  plot.height = 480.0;
  plot.width = 640.0;
  PlotSeries none{"no breach", {}, {}, false, true};
  PlotSeries outer{"outer surface", {}, {}, false, true};
  PlotSeries canal{"canal", {}, {}, false, true};
  for (std::size_t n = 0; n < std::min(max, rows.size()); ++n) {
    const StudyRow& row = rows[n];
    PlotSeries& series = row[StudyColumn::breach_canal_mm] > 0.0 ? canal
                         : row[StudyColumn::breach] > 0.0        ? outer
                                                                 : none;
    series.x.push_back(row[across]);
    series.y.push_back(row[up]);
  }
  plot.series = {none, canal, outer};
  return plot;
}

}  // namespace spinaltap
