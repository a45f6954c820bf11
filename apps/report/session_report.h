#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "apps/report/html_report.h"
#include "apps/report/svg_plot.h"
#include "core/session/cycle.h"
#include "core/session/real_time/real_time.h"

namespace spinaltap {

/// Where states began, along the depth: each state's first and last beginning alone, since a strut may bring back a
/// state often.
std::vector<PlotMarker> state_markers(std::span<const SessionEvent> events);

/// What an event's value means, with its unit: "cancellous", "12.3 N", "0.45 mm"; empty where it has none.
std::string value_text(const SessionEvent& event);

/// A heading and a table of what happened. Nothing where nothing did.
void add_events(std::span<const SessionEvent> events, std::size_t lost, HtmlReport& report);

/// A table of text; its first column names the rows.
struct TextRows {
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;
};
/// A real-time run's threads: rates and counts of cycles.
TextRows pace_rows(const RealTimeReport& run);
/// Their latencies, µs: of waking up and of work, by the clock and by CPU time.
TextRows latency_rows(const RealTimeReport& run);

/// A heading, what the user's rights did not allow, the tables of threads, and histograms of the latencies.
void add_real_time(const RealTimeReport& run, HtmlReport& report);

}  // namespace spinaltap
