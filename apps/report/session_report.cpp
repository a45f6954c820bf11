#include "apps/report/session_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "apps/report/text.h"
#include "core/session/drill_state.h"

namespace spinaltap {
namespace {

struct NamedThread {
  const char* name;
  const PaceReport* pace;
};

std::vector<NamedThread> threads_of(const RealTimeReport& run) {
  std::vector<NamedThread> threads{
      {"collision", &run.collision}, {"tool", &run.tool}, {"display", &run.display}, {"force output", &run.output}};
  std::erase_if(threads, [](const NamedThread& thread) { return thread.pace->cycles + thread.pace->idle == 0; });
  return threads;
}

DrillState state_of(const SessionEvent& event) {
  return static_cast<DrillState>(std::clamp(std::lround(event.value), 0L, 4L));
}

/// Counts of octaves over the powers of ten of their times, as steps.
PlotSeries histogram(const std::string& name, const std::vector<std::uint64_t>& counts) {
  PlotSeries series;
  series.name = name;
  series.step = true;
  for (std::size_t n = 0; n < counts.size(); ++n) {
    series.x.push_back(static_cast<double>(n) * std::log10(2.0));
    series.y.push_back(static_cast<double>(counts[n]));
  }
  if (counts.empty()) return series;
  series.x.push_back(static_cast<double>(counts.size()) * std::log10(2.0));
  series.y.push_back(series.y.back());
  return series;
}

Plot latency_plot(const std::string& title, const std::vector<NamedThread>& threads,
                  std::vector<std::uint64_t> PaceReport::*counts) {
  Plot plot;
  plot.title = title;
  plot.x_label = "time";
  plot.x_unit = "powers of ten of µs";
  plot.y_label = "cycles";
  plot.log_y = true;
  plot.x_low = 0.0;
  plot.x_high = 5.0;
  for (const NamedThread& thread : threads) plot.series.push_back(histogram(thread.name, thread.pace->*counts));
  plot.markers = {{1.0, "10 µs"}, {2.0, "0.1 ms"}, {3.0, "1 ms"}, {4.0, "10 ms"}};
  return plot;
}

}  // namespace

std::vector<PlotMarker> state_markers(std::span<const SessionEvent> events) {
  std::vector<PlotMarker> markers;
  for (std::size_t state = 1; state <= 4; ++state) {
    const auto is_it = [&](const SessionEvent& event) {
      return event.kind == EventKind::state && state_of(event) == static_cast<DrillState>(state);
    };
    const auto first = std::find_if(events.begin(), events.end(), is_it);
    if (first == events.end()) continue;
    const auto last = std::find_if(events.rbegin(), events.rend(), is_it);
    const std::string name(name_of(static_cast<DrillState>(state)));
    markers.push_back({first->depth_mm, name});
    if (std::abs(last->depth_mm - first->depth_mm) > 0.5) markers.push_back({last->depth_mm, name});
  }
  return markers;
}

std::string value_text(const SessionEvent& event) {
  switch (event.kind) {
    case EventKind::contact:
    case EventKind::invalid_pose:
    case EventKind::tool_change:
      return {};
    case EventKind::state:
      return std::string(name_of(state_of(event)));
    case EventKind::breakthrough:
    case EventKind::stop_thrust:
    case EventKind::touch:
      return readable_number(event.value, 1) + " N";
    case EventKind::heat_limit:
      return readable_number(event.value, 1) + " °C";
    case EventKind::device_lost:
      return readable_number(event.value, 2) + " s";
    case EventKind::stall:
      return readable_number(event.value, 1) + " N·mm";
    case EventKind::record_lost:
      return readable_number(event.value, 0) + " cycles";
    case EventKind::outer_breach:
    case EventKind::canal_breach:
    case EventKind::stop_clearance:
    case EventKind::stop_breach:
    case EventKind::plunge:
    case EventKind::jump:
    case EventKind::outside_volume:
    case EventKind::gave_up:
      return readable_number(event.value, 2) + " mm";
  }
  return {};
}

void add_events(std::span<const SessionEvent> events, std::size_t lost, HtmlReport& report) {
  if (events.empty()) return;
  constexpr std::size_t kMaxRows = 60;  // of thousands nobody reads more
  report.add_heading("What happened");
  std::vector<std::vector<std::string>> rows;
  for (const SessionEvent& event : events.first(std::min(events.size(), kMaxRows))) {
    const Vec3& p = event.place_mm;
    rows.push_back({std::string(name_of(event.kind)), value_text(event), readable_number(event.time_s, 3),
                    readable_number(event.depth_mm, 2),
                    readable_number(p.x(), 1) + ", " + readable_number(p.y(), 1) + ", " + readable_number(p.z(), 1)});
  }
  report.add_table({"event", "", "time (s)", "depth (mm)", "place (x, y, z; mm)"}, rows);
  if (events.size() > kMaxRows) {
    report.add_note("The first " + std::to_string(kMaxRows) + " of " + std::to_string(events.size()) +
                    " events; events.csv has them all.");
  }
  if (lost > 0) report.add_note(std::to_string(lost) + " further events were not kept.");
}

TextRows pace_rows(const RealTimeReport& run) {
  TextRows table{{"thread", "rate (Hz)", "cycles", "missed", "skipped", "idle"}, {}};
  for (const auto& [name, pace] : threads_of(run)) {
    std::vector<std::string> row{name, readable_number(pace->rate_hz, 1)};
    for (const std::uint64_t count : {pace->cycles, pace->missed, pace->skipped, pace->idle}) {
      row.push_back(readable_number(static_cast<double>(count), 0));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

TextRows latency_rows(const RealTimeReport& run) {
  TextRows table{{"latency (µs)", "p50", "p99", "p99.9", "max"}, {}};
  const auto add = [&](const std::string& name, const TimeSpread& spread) {
    table.rows.push_back({name});
    for (const double us : {spread.p50_us, spread.p99_us, spread.p999_us, spread.max_us}) {
      table.rows.back().push_back(readable_number(us, 1));
    }
  };
  for (const auto& [name, pace] : threads_of(run)) {
    add(std::string(name) + ", wake-up", pace->wake_up);
    add(std::string(name) + ", work", pace->work_wall);
    add(std::string(name) + ", work, CPU", pace->work_cpu);
  }
  return table;
}

void add_real_time(const RealTimeReport& run, HtmlReport& report) {
  report.add_heading("Real time");
  report.add_text(
      "For " + readable_number(run.seconds, 1) + " s, " + (run.has_priority ? "with" : "without") +
      " real-time priority, " + (run.has_locked_memory ? "with" : "without") +
      " locked memory. Wake-up: from when a cycle was due to when it began. Work: until the cycle's end, by "
      "the clock and by the thread's CPU time. Missed: cycles that ended after the next was due. Skipped: "
      "due times that passed without a cycle. Idle: due times with nothing new to do.");
  for (const std::string& warning : run.warnings) report.add_note(warning);
  for (const TextRows& table : {pace_rows(run), latency_rows(run)}) report.add_table(table.head, table.rows);
  const std::vector<NamedThread> threads = threads_of(run);
  report.add_svg(svg_plot(latency_plot("How late cycles began", threads, &PaceReport::wake_up_histogram)));
  report.add_svg(svg_plot(latency_plot("How long cycles worked", threads, &PaceReport::work_histogram)));
}

}  // namespace spinaltap
