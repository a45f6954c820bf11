#include "apps/spinaltap/drill_figures.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "apps/report/session_report.h"
#include "apps/report/text_table.h"
#include "apps/spinaltap/command.h"
#include "apps/spinaltap/mesh_figures.h"
#include "core/points/neighbour_distances.h"

namespace spinaltap {
namespace {

/// The furthest that the hand went after a stop or a breakthrough, mm; NaN where there was none.
double overshoot_mm(const std::vector<SessionEvent>& events) {
  double most_mm = std::nan("");
  for (const SessionEvent& event : events) {
    if (event.kind == EventKind::overshoot) most_mm = std::fmax(most_mm, event.value);
  }
  return most_mm;
}

Json json_of(const TimeSpread& spread) {
  return {{"p50_us", spread.p50_us}, {"p99_us", spread.p99_us}, {"p999_us", spread.p999_us}, {"max_us", spread.max_us}};
}

Json json_of(const PaceReport& pace) {
  return {{"rate_hz", pace.rate_hz},
          {"cycles", pace.cycles},
          {"idle", pace.idle},
          {"missed", pace.missed},
          {"skipped", pace.skipped},
          {"wake_up", json_of(pace.wake_up)},
          {"work", json_of(pace.work_wall)},
          {"work_cpu", json_of(pace.work_cpu)},
          {"wake_up_histogram", pace.wake_up_histogram},
          {"work_histogram", pace.work_histogram}};
}

Json json_of(const RealTimeReport& run) {
  return {{"seconds", run.seconds},
          {"has_priority", run.has_priority},
          {"has_locked_memory", run.has_locked_memory},
          {"remarks", run.remarks},
          {"collision", json_of(run.collision)},
          {"tool", json_of(run.tool)},
          {"display", json_of(run.display)},
          {"output", json_of(run.output)}};
}

Json json_of(const SessionEvent& event) {
  return {
      {"event", name_of(event.kind)},
      {"cycle", event.cycle},
      {"time_s", event.time_s},
      {"depth_mm", number_or_null(event.depth_mm)},
      {"place_mm",
       {number_or_null(event.place_mm.x()), number_or_null(event.place_mm.y()), number_or_null(event.place_mm.z())}},
      {"value", number_or_null(event.value)}};
}

void print_rows(const TextRows& table) {
  std::vector<TextTable::Column> columns;
  for (const std::string& name : table.head) columns.push_back({name, "", !columns.empty()});
  TextTable text(std::move(columns));
  for (const std::vector<std::string>& row : table.rows) text.add_row(row);
  std::fputs(text.aligned().c_str(), stdout);
}

void print_events(const Drilling& drilling) {
  constexpr std::size_t kMost = 24;
  for (std::size_t n = 0; n < std::min(drilling.events.size(), kMost); ++n) {
    const SessionEvent& event = drilling.events[n];
    std::printf("  %9.3f s  at %7.2f mm  %-14s %s\n", event.time_s, event.depth_mm,
                std::string(name_of(event.kind)).c_str(), value_text(event).c_str());
  }
  const std::size_t further = drilling.events.size() + drilling.events_lost - std::min(drilling.events.size(), kMost);
  if (further > 0) std::printf("  and %zu further events: see events.csv\n", further);
}

}  // namespace

void print_drilling(const DrillFigures& figures, const DensityCalibration& density) {
  const Drilling& drilling = figures.drilling;
  print_figure("points in the cylinder", static_cast<double>(drilling.points), "", 0);
  print_figure("points in bone", static_cast<double>(drilling.points_in_bone), "", 0);
  print_figure("points removed", static_cast<double>(drilling.removed), "", 0);
  const NeighbourDistances neighbours = neighbour_distances(drilling.volumes.front(), false);
  print_figure("nearest neighbours, mean", neighbours.mean_mm, "mm", 4);
  print_figure("nearest neighbours, standard deviation", neighbours.deviation_mm, "mm", 4);
  print_figure("memory", drilling.bytes_per_point, "bytes/point", 3);
  for (const auto& [name, value] : figures.hand_words) print_figure("hand, " + name, value);
  print_figure("cycles", static_cast<double>(drilling.cycles), "", 0);
  print_figure("drilled for", drilling.session_s, "s", 3);
  if (drilling.real_time) {
    for (const std::string& remark : drilling.real_time->remarks) print_figure("remark", remark);
    for (const TextRows& table : {pace_rows(*drilling.real_time), latency_rows(*drilling.real_time)}) print_rows(table);
  } else {
    const DrillRates rates = drill_rates(drilling.rows);
    print_figure("rate, first tenth of the path", rates.first_tenth, "cycles/s", 0);
    print_figure("rate, last tenth", rates.last_tenth, "cycles/s", 0);
  }
  print_figure("greatest thrust", drilling.most_thrust_n, "N", 2);
  print_figure("greatest torque", drilling.most_torque_n_mm, "N·mm", 1);
  if (std::isfinite(drilling.least_outer_mm)) {
    print_figure("least clearance, outer surface", drilling.least_outer_mm, "mm", 2);
  }
  if (std::isfinite(drilling.least_canal_mm)) {
    print_figure("least clearance, canal", drilling.least_canal_mm, "mm", 2);
  }
  print_figure("density at 0 HU", density.law.at_0_hu, "g/cm3", 4);
  print_figure("density per 1000 HU", 1000.0 * density.law.per_hu, "g/cm3", 4);
  if (density.rms_residual_g_cm3 > 0.0) {
    print_figure("calibration misses the line by", density.rms_residual_g_cm3, "g/cm3 rms", 4);
  }
  if (figures.setup.has_clearances && !figures.bone.no_landmarks().empty()) {
    print_figure("no canal found", figures.bone.no_landmarks());
  }
  if (figures.cycles_not_recorded > 0) {
    print_figure("cycles not recorded", static_cast<double>(figures.cycles_not_recorded), "", 0);
  }
  print_events(drilling);
}

Json drilling_json(const DrillFigures& figures, const DensityCalibration& density) {
  const Drilling& drilling = figures.drilling;
  const DrillPath& path = figures.setup.path;
  const NeighbourDistances neighbours = neighbour_distances(drilling.volumes.front(), false);
  Json json{{"path", path.name},
            {"length_mm", path.length_mm()},
            {"hand", figures.hand_words},
            {"discs", drilling.discs},
            {"points_per_disc", drilling.points_per_disc},
            {"points", drilling.points},
            {"points_in_bone", drilling.points_in_bone},
            {"removed", drilling.removed},
            {"bytes_per_point", drilling.bytes_per_point},
            {"nearest_neighbours_mm",
             {{"least", neighbours.least_mm},
              {"mean", neighbours.mean_mm},
              {"deviation", neighbours.deviation_mm},
              {"most", neighbours.most_mm}}},
            {"cycles", drilling.cycles},
            {"session_s", drilling.session_s},
            {"deepest_mm", number_or_null(drilling.deepest_mm)},
            {"greatest_thrust_N", drilling.most_thrust_n},
            {"greatest_torque_N_mm", drilling.most_torque_n_mm},
            {"least_outer_clearance_mm", number_or_null(drilling.least_outer_mm)},
            {"least_canal_clearance_mm", number_or_null(drilling.least_canal_mm)},
            {"stopped", drilling.is_stopped},
            {"overshoot_mm", number_or_null(overshoot_mm(drilling.events))},
            {"events_lost", drilling.events_lost},
            {"cycles_not_recorded", figures.cycles_not_recorded},
            {"density_at_0_hu_g_cm3", density.law.at_0_hu},
            {"density_per_hu_g_cm3", density.law.per_hu},
            {"calibration_rms_g_cm3", density.rms_residual_g_cm3},
            {"calibration_most_g_cm3", density.most_residual_g_cm3},
            {"mesh", report_mesh(figures.mesh)}};
  Json events = Json::array();
  for (const SessionEvent& event : drilling.events) events.push_back(json_of(event));
  json["events"] = std::move(events);
  if (drilling.real_time) {
    json["real_time"] = json_of(*drilling.real_time);
  } else {
    const DrillRates rates = drill_rates(drilling.rows);
    json["cycles_seconds"] = drilling.seconds;
    json["cycles_per_s_first_tenth"] = rates.first_tenth;
    json["cycles_per_s_middle_tenth"] = rates.middle_tenth;
    json["cycles_per_s_last_tenth"] = rates.last_tenth;
  }
  return json;
}

}  // namespace spinaltap
