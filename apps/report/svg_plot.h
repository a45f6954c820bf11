#pragma once

#include <limits>
#include <string>
#include <vector>

#include "apps/report/plot_curve.h"

namespace spinaltap {

/// One curve, or a cloud of points. Values that are not finite, and on a log axis those not above 0, break it.
struct PlotSeries {
  std::string name;  ///< in the legend, which appears where there are two or more names, or at the curve
  std::vector<double> x;
  std::vector<double> y;  ///< as many as x
  bool step = false;      ///< each value holds until the next x, as counts per step do
  bool points = false;    ///< a dot for each value, in place of a curve
  bool dashed = false;
  std::string colour = {};  ///< as SVG has it; empty: the next one
};

/// An area between two curves, for example from the 5th to the 95th percentile.
struct PlotBand {
  std::string name;
  std::vector<double> x;
  std::vector<double> low;   ///< as many as x
  std::vector<double> high;  ///< as many as x
};

/// An area over the whole width, under all curves, with its name in it.
struct PlotZone {
  double low = 0.0;
  double high = 0.0;
  std::string name;
  std::string colour;  ///< as SVG has it
};

/// A dashed vertical line with a label above the plot, beside it.
struct PlotMarker {
  double x = 0.0;
  std::string label;
};

/// Curves over one x axis. Units go into the axes' titles: "depth (mm)".
struct Plot {
  std::string title;
  std::string x_label;
  std::string x_unit;
  std::string y_label;
  std::string y_unit;
  std::vector<PlotSeries> series;
  std::vector<PlotBand> bands;
  std::vector<PlotMarker> markers;
  std::vector<PlotZone> zones;
  bool names_at_curves = false;  ///< in place of a legend
  bool log_y = false;
  bool y_from_zero = false;  ///< linear axes: 0 is in the range
  /// Where the x axis must reach at least, to align plots; NaN: no further than the data.
  double x_low = std::numeric_limits<double>::quiet_NaN();
  double x_high = std::numeric_limits<double>::quiet_NaN();
  /// Where the y axis ends, whatever the data: curves leave the picture there. NaN: with the data.
  double y_low = std::numeric_limits<double>::quiet_NaN();
  double y_high = std::numeric_limits<double>::quiet_NaN();
  double width = 940.0;  ///< drawing units; the text is 13 units high
  double height = 300.0;
};

/// From values to drawing units; y runs down.
struct PlotAxes {
  AxisScale x;
  AxisScale y;
};
/// Where svg_plot() draws. Throws Error as it does.
PlotAxes plot_axes(const Plot& plot);

/// The plot as an <svg> element for a place in an HTML page, without external references. Long curves are thinned to
/// the first, lowest, highest and last point of every half unit, which looks the same. Throws Error where x and y
/// differ in length.
std::string svg_plot(const Plot& plot);
/// The same as a file of its own, .svg.
std::string svg_plot_file(const Plot& plot);

}  // namespace spinaltap
