#include <algorithm>

#include "apps/report/html_report.h"
#include "apps/report/svg_plot.h"
#include "apps/report/text.h"
#include "apps/spinaltap/bench/bench_results.h"
#include "core/base/text_writer.h"

namespace spinaltap {
namespace {

/// Values of the runs, each once, in their order.
template <class Value>
auto distinct(const std::vector<BenchResult>& runs, const Value& value) {
  std::vector<std::decay_t<decltype(value(runs.front()))>> found;
  for (const BenchResult& run : runs) {
    if (std::find(found.begin(), found.end(), value(run)) == found.end()) found.push_back(value(run));
  }
  return found;
}

PlotSeries curve(const BenchResult& run, const std::string& name) {
  const double path_mm = workload_path(3.0).length_mm();
  const double cycles = static_cast<double>(run.measured.path_cycles);
  PlotSeries series;
  series.name = name;
  for (const Stretch& part : run.measured.curve) {
    series.x.push_back(0.5 * static_cast<double>(part.begin + part.end) / cycles * path_mm);
    series.y.push_back(part.cycles_per_cpu_s());
  }
  return series;
}

Plot empty_plot(const std::string& title) {
  Plot plot;
  plot.title = title;
  plot.x_label = "depth of the tip along the path";
  plot.x_unit = "mm";
  plot.y_label = "collision cycles a second of CPU time";
  plot.log_y = true;
  plot.x_low = 0.0;
  plot.x_high = workload_path(3.0).length_mm();
  plot.height = 380.0;
  return plot;
}

}  // namespace

std::string bench_page(const BenchResults& results, const std::string& machine) {
  HtmlReport report("Drilling engines: collision rates along the path");
  report.add_text(machine);
  if (!results.runs.empty()) {
    const double diameter_mm = results.runs.front().diameter_mm;
    std::vector<BenchResult> runs;
    for (const BenchResult& run : results.runs) {
      const bool is_first = std::none_of(runs.begin(), runs.end(), [&](const BenchResult& other) {
        return other.engine == run.engine && other.motion == run.motion && other.spacing_mm == run.spacing_mm;
      });
      if (run.diameter_mm == diameter_mm && is_first) runs.push_back(run);
    }
    report.add_text("Bit of " + short_text(diameter_mm) +
                    " mm, 0.001 mm a cycle. The paper's computers made 400 cycles a "
                    "second at the end of its path, on a Pentium 4 of 1.4 GHz, at 0.1 mm.");
    report.add_heading("Figure 20: on the path");
    for (const double spacing_mm : distinct(runs, [](const BenchResult& run) { return run.spacing_mm; })) {
      Plot plot = empty_plot("On-path, points " + short_text(spacing_mm) + " mm apart");
      for (const BenchResult& run : runs) {
        if (run.motion == WorkloadMotion::on_path && run.spacing_mm == spacing_mm) {
          plot.series.push_back(curve(run, run.engine));
        }
      }
      if (!plot.series.empty()) report.add_svg(svg_plot(plot));
    }
    report.add_heading("Figure 21: on the path and 1.2 mm beside it");
    for (const std::string& engine : distinct(runs, [](const BenchResult& run) { return run.engine; })) {
      Plot plot = empty_plot("Engine " + engine);
      for (const BenchResult& run : runs) {
        if (run.engine != engine) continue;
        if (run.motion != WorkloadMotion::on_path && run.motion != WorkloadMotion::off_path) continue;
        plot.series.push_back(curve(run, std::string(name_of(run.motion)) + ", " + short_text(run.spacing_mm) + " mm"));
      }
      if (!plot.series.empty()) report.add_svg(svg_plot(plot));
    }
  }
  report.add_note(
      "Curves of engines that are timed over the whole path are means over a hundredth of it; those of the "
      "others join windows of some cycles.");
  return report.html();
}

}  // namespace spinaltap
