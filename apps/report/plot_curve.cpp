#include "apps/report/plot_curve.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "apps/report/text.h"

namespace spinaltap {

bool AxisScale::shows(double value) const { return std::isfinite(value) && (!log || value > 0.0); }

double AxisScale::operator()(double value) const {
  const double share = log ? std::log(value / low) / std::log(high / low) : (value - low) / (high - low);
  return from + share * (to - from);
}

std::vector<PlotRun> curve_runs(std::span<const double> x, std::span<const double> y, const AxisScale& x_scale,
                                const AxisScale& y_scale) {
  std::vector<PlotRun> runs;
  bool open = false;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!x_scale.shows(x[i]) || !y_scale.shows(y[i])) {
      open = false;
      continue;
    }
    if (!open) runs.emplace_back();
    open = true;
    runs.back().emplace_back(x_scale(x[i]), y_scale(y[i]));
  }
  return runs;
}

PlotRun thinned(const PlotRun& run, double column) {
  const auto goes_back = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return b.x() < a.x(); };
  if (std::adjacent_find(run.begin(), run.end(), goes_back) != run.end()) return run;
  PlotRun thin;
  for (auto first = run.begin(); first != run.end();) {
    const double cell = std::floor(first->x() / column);
    const auto end = std::find_if(first, run.end(), [&](const auto& p) { return std::floor(p.x() / column) != cell; });
    const auto [lowest, highest] =
        std::minmax_element(first, end, [](const auto& a, const auto& b) { return a.y() < b.y(); });
    std::vector<PlotRun::const_iterator> kept{first, std::min(lowest, highest), std::max(lowest, highest), end - 1};
    kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
    for (const auto& p : kept) thin.push_back(*p);
    first = end;
  }
  return thin;
}

PlotRun stepped(const PlotRun& run) {
  PlotRun steps;
  for (const Eigen::Vector2d& p : run) {
    if (!steps.empty() && steps.back().y() != p.y()) steps.emplace_back(p.x(), steps.back().y());
    steps.push_back(p);
  }
  return steps;
}

std::string path_data(const PlotRun& run) {
  std::string data;
  for (const Eigen::Vector2d& p : run) {
    data += (data.empty() ? "M" : "L") + svg_number(p.x(), 1) + " " + svg_number(p.y(), 1);
  }
  // A point alone has no length: with round caps this draws it as a dot.
  return run.size() == 1 ? data + "h0" : data;
}

}  // namespace spinaltap
