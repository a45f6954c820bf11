#include "apps/spinaltap-planner/drill/drill_plots.h"

#include <algorithm>

namespace spinaltap {
namespace {

PlotSeries curve_of(std::span<const DepthRow> rows, const char* name, double DepthRow::*value) {
  PlotSeries series;
  series.name = name;
  for (const DepthRow& row : rows) {
    series.x.push_back(row.depth_mm);
    series.y.push_back(row.*value);
  }
  return series;
}

}  // namespace

Plot drill_plot(DrillCurve curve, std::span<const DepthRow> rows, double length_mm) {
  Plot plot;
  plot.x_label = "depth";
  plot.x_unit = "mm";
  plot.x_low = rows.empty() ? 0.0 : std::min(0.0, rows.front().depth_mm);
  plot.x_high = length_mm;
  plot.markers = {{0.0, "Entry"}, {length_mm, "Target"}};
  plot.y_from_zero = true;
  switch (curve) {
    case DrillCurve::thrust:
      plot.y_label = "thrust";
      plot.y_unit = "N";
      plot.series = {curve_of(rows, "thrust", &DepthRow::thrust_n)};
      break;
    case DrillCurve::torque:
      plot.y_label = "torque";
      plot.y_unit = "N·mm";
      plot.series = {curve_of(rows, "torque", &DepthRow::torque_n_mm)};
      break;
    case DrillCurve::density:
      plot.y_label = "density";
      plot.y_unit = "HU";
      plot.series = {curve_of(rows, "density", &DepthRow::hu)};
      break;
    case DrillCurve::clearance:
      plot.y_label = "clearance";
      plot.y_unit = "mm";
      plot.series = {curve_of(rows, "outer surface", &DepthRow::outer_mm),
                     curve_of(rows, "canal", &DepthRow::canal_mm)};
      break;
  }
  return plot;
}

}  // namespace spinaltap
