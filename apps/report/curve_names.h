#pragma once

#include <Eigen/Geometry>

#include <span>
#include <string>
#include <vector>

#include "apps/report/plot_curve.h"

namespace spinaltap {

/// A curve and what it is called. Drawing units; no name: only others keep away from it.
struct NamedCurve {
  std::string name;
  std::vector<PlotRun> runs;
};

/// Where each curve's name stands: as near to its own curve as leaves all curves, the other names and `taken` free, and
/// no nearer to another curve. Where there is no such place names may lie on curves, never on each other or on `taken`.
/// Empty for curves without a name or a point in the room, and where names would cover each other.
std::vector<Eigen::AlignedBox2d> place_curve_names(std::span<const NamedCurve> curves, const Eigen::AlignedBox2d& room,
                                                   double font_size, std::vector<Eigen::AlignedBox2d> taken = {});

/// The parts of runs between two heights, drawing units.
std::vector<PlotRun> cut_to_heights(const std::vector<PlotRun>& runs, double y_min, double y_max);

/// A label of a line at x, beside it: to its right, or its left where the picture ends.
struct LineLabel {
  double x = 0.0;        ///< of the line
  double width = 0.0;    ///< of the text
  bool is_left = false;  ///< of its line
  int row = 0;           ///< 0: the lowest
};

/// Puts the labels of lines into rows above each other so that none lies on another or on another's line, which goes up
/// to its label. Lines in any order; `end`: where the picture ends.
void lay_out_line_labels(std::span<LineLabel> labels, double end, double gap);

}  // namespace spinaltap
