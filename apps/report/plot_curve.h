#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

namespace spinaltap {

/// Points of a curve without a gap, drawing units.
using PlotRun = std::vector<Eigen::Vector2d>;

/// Maps values to drawing units along one axis.
struct AxisScale {
  double low = 0.0;
  double high = 1.0;
  double from = 0.0;  ///< drawing units at `low`
  double to = 1.0;    ///< drawing units at `high`
  bool log = false;

  /// Whether the value can be drawn: finite, and above 0 on a log axis.
  bool shows(double value) const;
  double operator()(double value) const;
};

/// The curve's runs between values that cannot be drawn. `x` and `y` have one length.
std::vector<PlotRun> curve_runs(std::span<const double> x, std::span<const double> y, const AxisScale& x_scale,
                                const AxisScale& y_scale);

/// The run with at most four points (first, lowest, highest, last) in each column of `column` units; a run whose x goes
/// back stays as it is.
PlotRun thinned(const PlotRun& run, double column);

/// The run as steps: each value holds until the next x.
PlotRun stepped(const PlotRun& run);

/// SVG path data of the run, "M1 2L3 4".
std::string path_data(const PlotRun& run);

}  // namespace spinaltap
