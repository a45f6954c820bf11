#pragma once

#include <string>
#include <vector>

namespace spinaltap {

/// Where an axis begins, ends and is labelled.
struct AxisTicks {
  double low = 0.0;  ///< the axis' ends; on a linear axis both are ticks
  double high = 1.0;
  std::vector<double> major;  ///< labelled, ascending
  std::vector<double> minor;  ///< grid lines without a label (log axes), ascending
};

/// Ticks at 1, 2 or 5 times a power of ten, about `count` of them, around [low, high].
/// An empty range is widened. Throws Error when an end is not finite.
AxisTicks linear_ticks(double low, double high, int count);

/// Ticks at powers of ten, with 2 and 5 labelled too below three decades. The ends are 1, 2 or 5 times a power of ten.
/// Throws Error when an end is not finite or not above 0.
AxisTicks log_ticks(double low, double high);

/// A tick's label: as few digits as tell the ticks apart; from 10,000 on with k, M or G.
/// `step` is the distance of neighbouring ticks; 0 on log axes.
std::string tick_label(double value, double step);

}  // namespace spinaltap
