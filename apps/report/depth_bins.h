#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace spinaltap {

/// A curve with more values than a plot has room for, gathered in bins of equal depth. A bin without a finite value
/// holds NaN.
struct DepthBins {
  std::vector<double> depth;  ///< middle of each bin
  std::vector<double> min;
  std::vector<double> median;
  std::vector<double> max;
};

/// Gathers values by depth into `bins` bins from the least to the greatest depth. Values or depths that are not finite
/// are passed over. Throws Error when the lengths differ or `bins` is 0.
DepthBins bin_by_depth(std::span<const double> depth, std::span<const double> values, std::size_t bins);

/// The median of the finite values; NaN where there is none.
double finite_median(std::vector<double> values);

}  // namespace spinaltap
