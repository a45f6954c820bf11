#include "apps/report/grade_plots.h"

#include <cmath>
#include <limits>
#include <utility>

namespace spinaltap {
namespace {

constexpr double kGradePlotHeight = 260.0;

Plot empty_plot(const GradedPath& graded, const std::string& title, const std::string& y_label,
                const std::string& y_unit) {
  Plot plot;
  plot.title = title;
  plot.x_label = "depth along the path";
  plot.x_unit = "mm";
  plot.y_label = y_label;
  plot.y_unit = y_unit;
  plot.x_low = 0.0;
  plot.x_high = graded.path.length_mm();
  plot.y_from_zero = true;
  plot.height = kGradePlotHeight;
  return plot;
}

template <class Value>
Plot plot_of(const GradedPath& graded, const std::string& title, const std::string& y_label, const std::string& y_unit,
             const Value& value) {
  Plot plot = empty_plot(graded, title, y_label, y_unit);
  PlotSeries series{y_label, {}, {}};
  for (const GradeRow& row : graded.grade.rows) {
    series.x.push_back(row.depth_mm);
    series.y.push_back(value(row));
  }
  plot.series = {series};
  return plot;
}

}  // namespace

std::string meaning_of(Grade grade) {
  switch (grade) {
    case Grade::A:
      return "A: no breach";
    case Grade::B:
      return "B: breach below 2 mm";
    case Grade::C:
      return "C: breach of 2 to below 4 mm";
    case Grade::D:
      return "D: breach of 4 to below 6 mm";
    case Grade::E:
      break;
  }
  return "E: breach of 6 mm or more";
}

Plot clearance_plot(const GradedPath& graded) {
  Plot plot = empty_plot(graded, "Clearance", "clearance", "mm");
  PlotSeries outer{"outer surface", {}, {}};
  PlotSeries canal{"canal", {}, {}};
  PlotSeries mouth{"outer surface at the entry, not counted", {}, {}};
  for (const GradeRow& row : graded.grade.rows) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    for (PlotSeries* series : {&outer, &canal, &mouth}) series->x.push_back(row.depth_mm);
    outer.y.push_back(row.is_entry ? kNone : row.outer_mm);
    mouth.y.push_back(row.is_entry ? row.outer_mm : kNone);
    canal.y.push_back(row.canal_mm);
  }
  // A line without a name has no place in the legend: where the tool touches the wall.
  const PlotSeries touching{"", {0.0, graded.path.length_mm()}, {0.0, 0.0}};
  plot.series = {outer, canal, mouth, touching};
  plot.markers = {{graded.grade.outer.depth_mm, "Nearest to the outer surface"},
                  {graded.grade.canal.depth_mm, "Nearest to the canal"}};
  if (!std::isfinite(graded.grade.canal.clearance_mm)) plot.markers.pop_back();
  if (!std::isfinite(graded.grade.outer.clearance_mm)) plot.markers.erase(plot.markers.begin());
  if (plot.markers.size() == 2 && plot.markers[1].x < plot.markers[0].x) std::swap(plot.markers[0], plot.markers[1]);
  return plot;
}

Plot hu_plot(const GradedPath& graded) {
  return plot_of(graded, "Bone in the tool's section", "mean CT number", "HU",
                 [](const GradeRow& row) { return row.hu; });
}

Plot bands_plot(const GradedPath& graded, const std::vector<double>& hu_bands) {
  Plot plot = empty_plot(graded, "Bone by CT number in the tool's section", "share", "%");
  const std::vector<std::string> names = band_names(hu_bands);
  for (std::size_t band = 0; band < names.size(); ++band) {
    PlotSeries series{names[band], {}, {}};
    for (const GradeRow& row : graded.grade.rows) {
      series.x.push_back(row.depth_mm);
      series.y.push_back(100.0 * row.hu_band_shares.at(band));
    }
    plot.series.push_back(series);
  }
  return plot;
}

Plot predicted_thrust_plot(const GradedPath& graded) {
  return plot_of(graded, "Predicted thrust", "thrust", "N", [](const GradeRow& row) { return row.thrust_n; });
}

}  // namespace spinaltap
