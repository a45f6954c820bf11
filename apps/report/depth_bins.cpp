#include "apps/report/depth_bins.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/base/error.h"

namespace spinaltap {

double finite_median(std::vector<double> values) {
  std::erase_if(values, [](double value) { return !std::isfinite(value); });
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : std::midpoint(values[half - 1], values[half]);
}

DepthBins bin_by_depth(std::span<const double> depth, std::span<const double> values, std::size_t bins) {
  if (depth.size() != values.size()) fail("depth bins: expected ", depth.size(), " values, found ", values.size());
  if (bins == 0) fail("depth bins: expected at least 1 bin, found 0");
  double first = std::numeric_limits<double>::infinity();
  double last = -first;
  for (const double d : depth) {
    if (!std::isfinite(d)) continue;
    first = std::min(first, d);
    last = std::max(last, d);
  }
  if (!(first <= last)) return {};
  const double width = (last - first) / static_cast<double>(bins);
  std::vector<std::vector<double>> gathered(bins);
  for (std::size_t i = 0; i < depth.size(); ++i) {
    if (!std::isfinite(depth[i]) || !std::isfinite(values[i])) continue;
    const double place = width > 0.0 ? (depth[i] - first) / width : 0.0;
    gathered[std::min(static_cast<std::size_t>(place), bins - 1)].push_back(values[i]);
  }
  DepthBins result;
  for (std::size_t bin = 0; bin < bins; ++bin) {
    const std::vector<double>& held = gathered[bin];
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    const auto [min, max] = std::minmax_element(held.begin(), held.end());
    result.depth.push_back(first + (static_cast<double>(bin) + 0.5) * width);
    result.min.push_back(held.empty() ? kNone : *min);
    result.max.push_back(held.empty() ? kNone : *max);
    result.median.push_back(finite_median(held));
  }
  return result;
}

}  // namespace spinaltap
