#include "apps/report/fixation_report.h"

#include <cmath>

#include "apps/report/text.h"

namespace spinaltap {
namespace {

constexpr double kTorquePlotHeight = 230.0;

}  // namespace

std::string banded_text(const FixationFigure& figure) {
  // As many digits as the band leaves sense in.
  const auto rounded = [](double value) {
    if (!(value > 0.0)) return std::string("0");
    const double unit = std::pow(10.0, std::floor(std::log10(value)) - 1.0);
    return readable_number(unit * std::round(value / unit), unit < 1.0 ? 2 : 0);
  };
  return rounded(figure.median) + " (" + rounded(figure.p05) + " to " + rounded(figure.p95) + ")";
}

std::vector<ReportRow> fixation_rows(const ScrewFixation& fixation) {
  return {{"Pull-out strength (5 to 95 %)", banded_text(fixation.pullout_n), "N"},
          {"Of it by cortex", readable_number(100.0 * fixation.cortical_share, 0), "%"},
          {"Axial stiffness, at most", banded_text(fixation.stiffness_n_mm), "N/mm"},
          {"Max insertion torque (5 to 95 %)", banded_text(fixation.max_torque_n_mm), "N·mm"},
          {"Thread in bone", readable_number(fixation.engaged_mm, 1), "mm"}};
}

Plot insertion_torque_plot(const ScrewFixation& fixation) {
  Plot plot;
  plot.title = "Insertion torque of the screw";
  plot.x_label = "depth of the tip along the path";
  plot.x_unit = "mm";
  plot.y_label = "torque";
  plot.y_unit = "N·mm";
  plot.x_low = 0.0;
  plot.x_high = fixation.rows.back().depth_mm;
  plot.y_from_zero = true;
  plot.height = kTorquePlotHeight;
  PlotSeries median{"median", {}, {}};
  PlotBand band{"5 to 95 %", {}, {}, {}};
  // The bounds are a factor that is the same all along.
  const FixationFigure& max = fixation.max_torque_n_mm;
  const double down = max.median > 0.0 ? max.p05 / max.median : 1.0;
  const double up = max.median > 0.0 ? max.p95 / max.median : 1.0;
  for (const FixationRow& row : fixation.rows) {
    median.x.push_back(row.depth_mm);
    median.y.push_back(row.torque_n_mm);
    band.x.push_back(row.depth_mm);
    band.low.push_back(row.torque_n_mm * down);
    band.high.push_back(row.torque_n_mm * up);
  }
  plot.series = {median};
  plot.bands = {band};
  return plot;
}

}  // namespace spinaltap
