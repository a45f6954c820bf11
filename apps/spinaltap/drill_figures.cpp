#include "apps/spinaltap/drill_figures.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "apps/report/session_report.h"
#include "apps/report/text_table.h"
#include "apps/spinaltap/command.h"
#include "apps/spinaltap/mesh_figures.h"
#include "core/drill/neighbour_distances.h"

namespace spinaltap {
namespace {

std::string fixed(double value, int digits) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

/// Mean cycles per second over a part of the rows, from their times; 0 where none was measured.
double rate(const std::vector<DepthRow>& rows, std::size_t begin, std::size_t end) {
  double cycles = 0.0;
  double seconds = 0.0;
  for (std::size_t i = begin; i < end; ++i) {
    if (!(rows[i].cycles_per_s > 0.0)) continue;
    cycles += static_cast<double>(rows[i].cycles);
    seconds += static_cast<double>(rows[i].cycles) / rows[i].cycles_per_s;
  }
  return seconds > 0.0 ? cycles / seconds : 0.0;
}

struct Rates {
  double first_tenth = 0.0;
  double middle_tenth = 0.0;
  double last_tenth = 0.0;
};

Rates rates_of(const std::vector<DepthRow>& rows) {
  if (rows.empty()) return {};
  const std::size_t count = rows.size();
  const std::size_t tenth = std::max<std::size_t>(1, count / 10);
  const std::size_t middle = (count - tenth) / 2;
  return {rate(rows, 0, tenth), rate(rows, middle, middle + tenth), rate(rows, count - tenth, count)};
}

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

DrillReportData report_data(const std::string& title, const CtVolume* ct, const DrillFigures& figures) {
  const Drilling& drilling = figures.drilling;
  DrillReportData data;
  data.title = title;
  data.ct = ct;
  data.path = figures.setup.path;
  data.bone_bounds_mm = figures.bone.model().bounds_mm();
  for (const DepthRow& row : drilling.rows) {
    data.depth_mm.push_back(row.depth_mm);
    data.density_hu.push_back(row.hu);
    data.density_g_per_cm3.push_back(row.density_g_cm3);
    data.thrust_N.push_back(row.thrust_n);
    data.torque_N_mm.push_back(row.torque_n_mm);
    data.lateral_N.push_back(row.lateral_n);
    data.outer_clearance_mm.push_back(row.outer_mm);
    data.canal_clearance_mm.push_back(row.canal_mm);
    if (!drilling.real_time) data.cycles_per_s.push_back(row.cycles_per_s);
    data.removed_points.push_back(static_cast<double>(row.removed));
  }
  data.events = drilling.events;
  data.events_lost = drilling.events_lost;
  data.real_time = drilling.real_time;
  const auto count = [](std::size_t value) { return std::to_string(value); };
  for (const auto& [name, value] : figures.hand.words) data.figures.push_back({"Hand, " + name, value, ""});
  data.figures.insert(data.figures.end(), {{"Spindle", fixed(figures.setup.options.spindle.rpm, 0), "rpm"},
                                           {"Discs", count(static_cast<std::size_t>(drilling.discs)), ""},
                                           {"Points per disc", count(drilling.points_per_disc), ""},
                                           {"Points in the cylinder", count(drilling.points), ""},
                                           {"Points in bone", count(drilling.points_in_bone), ""},
                                           {"Points removed", count(drilling.removed), ""},
                                           {"Cycles", count(drilling.cycles), ""},
                                           {"Drilled for", fixed(drilling.session_s, 2), "s"}});
  if (!drilling.real_time) {
    const Rates rates = rates_of(drilling.rows);
    data.figures.insert(data.figures.end(), {{"Time of all cycles", fixed(drilling.seconds, 2), "s"},
                                             {"Rate, first tenth of the path", fixed(rates.first_tenth, 0), "cycles/s"},
                                             {"Rate, middle tenth", fixed(rates.middle_tenth, 0), "cycles/s"},
                                             {"Rate, last tenth", fixed(rates.last_tenth, 0), "cycles/s"}});
  }
  data.figures.insert(data.figures.end(),
                      {{"Greatest thrust", fixed(drilling.most_thrust_n, 2), "N"},
                       {"Greatest torque", fixed(drilling.most_torque_n_mm, 1), "N·mm"},
                       {"First bone at depth", fixed(drilling.entry_depth_mm, 2), "mm"},
                       {"Drilled mesh, triangles", count(figures.mesh.triangles), ""},
                       {"Drilled mesh, closed", figures.mesh.closed() ? "yes" : "no", ""},
                       {"Drilled mesh, pieces", count(figures.mesh.pieces), ""},
                       {"Drilled mesh, volume", fixed(figures.mesh.volume_mm3 / 1000.0, 2), "cm³"}});
  if (!figures.bone.remark().empty())
    data.notes.push_back("No canal and no sides were found: " + figures.bone.remark());
  if (figures.cycles_not_recorded > 0) {
    data.notes.push_back("The record lacks " + count(figures.cycles_not_recorded) + " cycles.");
  }
  return data;
}

void print_drilling(const DrillFigures& figures) {
  const Drilling& drilling = figures.drilling;
  print_figure("points in the cylinder", static_cast<double>(drilling.points), "", 0);
  print_figure("points in bone", static_cast<double>(drilling.points_in_bone), "", 0);
  print_figure("points removed", static_cast<double>(drilling.removed), "", 0);
  const NeighbourDistances neighbours = neighbour_distances(drilling.volumes.front(), false);
  print_figure("nearest neighbours, mean", neighbours.mean_mm, "mm", 4);
  print_figure("nearest neighbours, standard deviation", neighbours.deviation_mm, "mm", 4);
  print_figure("memory", drilling.bytes_per_point, "bytes/point", 3);
  for (const auto& [name, value] : figures.hand.words) print_figure("hand, " + name, value);
  print_figure("cycles", static_cast<double>(drilling.cycles), "", 0);
  print_figure("drilled for", drilling.session_s, "s", 3);
  if (drilling.real_time) {
    for (const std::string& remark : drilling.real_time->remarks) print_figure("remark", remark);
    for (const TextRows& table : {pace_rows(*drilling.real_time), latency_rows(*drilling.real_time)}) print_rows(table);
  } else {
    const Rates rates = rates_of(drilling.rows);
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
  print_figure("density at 0 HU", figures.density.law.at_0_hu, "g/cm3", 4);
  print_figure("density per 1000 HU", 1000.0 * figures.density.law.per_hu, "g/cm3", 4);
  if (figures.density.rms_residual_g_cm3 > 0.0) {
    print_figure("calibration misses the line by", figures.density.rms_residual_g_cm3, "g/cm3 rms", 4);
  }
  if (!figures.bone.remark().empty()) print_figure("no canal found", figures.bone.remark());
  if (figures.cycles_not_recorded > 0) {
    print_figure("cycles not recorded", static_cast<double>(figures.cycles_not_recorded), "", 0);
  }
  print_events(drilling);
}

Json drilling_json(const DrillFigures& figures) {
  const Drilling& drilling = figures.drilling;
  const DrillPath& path = figures.setup.path;
  const NeighbourDistances neighbours = neighbour_distances(drilling.volumes.front(), false);
  Json json{{"path", path.name},
            {"length_mm", path.length_mm()},
            {"hand", figures.hand.words},
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
            {"density_at_0_hu_g_cm3", figures.density.law.at_0_hu},
            {"density_per_hu_g_cm3", figures.density.law.per_hu},
            {"calibration_rms_g_cm3", figures.density.rms_residual_g_cm3},
            {"calibration_most_g_cm3", figures.density.most_residual_g_cm3},
            {"mesh", report_mesh(figures.mesh)}};
  Json events = Json::array();
  for (const SessionEvent& event : drilling.events) events.push_back(json_of(event));
  json["events"] = std::move(events);
  if (drilling.real_time) {
    json["real_time"] = json_of(*drilling.real_time);
  } else {
    const Rates rates = rates_of(drilling.rows);
    json["cycles_seconds"] = drilling.seconds;
    json["cycles_per_s_first_tenth"] = rates.first_tenth;
    json["cycles_per_s_middle_tenth"] = rates.middle_tenth;
    json["cycles_per_s_last_tenth"] = rates.last_tenth;
  }
  return json;
}

}  // namespace spinaltap
