#include "apps/report/drilling_report.h"

#include <algorithm>

#include "apps/report/heat_figures.h"
#include "apps/report/text.h"
#include "core/base/text_writer.h"
#include "core/force/force_band.h"
#include "mesh/mesh_io.h"

namespace spinaltap {
namespace {

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

std::string events_csv(const std::vector<SessionEvent>& events) {
  SessionRecord record;
  record.events = events;
  TextStream csv;
  write_events_csv(record, csv);
  return csv.str();
}

}  // namespace

DrillRates drill_rates(const std::vector<DepthRow>& rows) {
  if (rows.empty()) return {};
  const std::size_t count = rows.size();
  const std::size_t tenth = std::max<std::size_t>(1, count / 10);
  const std::size_t middle = (count - tenth) / 2;
  return {rate(rows, 0, tenth), rate(rows, middle, middle + tenth), rate(rows, count - tenth, count)};
}

DrillReportData report_data(const std::string& title, const CtVolume* ct, const DrillFigures& figures) {
  const Drilling& drilling = figures.drilling;
  DrillReportData data;
  data.title = title;
  data.ct = ct;
  data.bone = &figures.bone;
  data.path = figures.setup.path;
  data.bone_bounds_mm = figures.bone.model().bounds_mm();
  if (data.path.screw) data.fixation = screw_fixation(figures.bone, data.path, figures.setup.material.density);
  const ForceBand band(figures.setup.material);
  for (const DepthRow& row : drilling.rows) {
    data.depth_mm.push_back(row.depth_mm);
    data.hu.push_back(row.hu);
    data.density_g_cm3.push_back(row.density_g_cm3);
    data.thrust_n.push_back(row.thrust_n);
    data.torque_n_mm.push_back(row.torque_n_mm);
    if (band.is_known()) {
      data.p05_thrust_n.push_back(row.thrust_band_n.low);
      data.p95_thrust_n.push_back(row.thrust_band_n.high);
      data.p05_torque_n_mm.push_back(row.torque_band_n_mm.low);
      data.p95_torque_n_mm.push_back(row.torque_band_n_mm.high);
    }
    data.lateral_n.push_back(row.lateral_n);
    data.clearance_outer_mm.push_back(row.outer_mm);
    data.clearance_canal_mm.push_back(row.canal_mm);
    data.temperature_c.push_back(row.temperature_c);
    if (!drilling.real_time) data.cycles_per_s.push_back(row.cycles_per_s);
    data.removed.push_back(static_cast<double>(row.removed));
  }
  data.has_voxels = drilling.left.voxels != nullptr;
  data.events = drilling.events;
  data.events_lost = drilling.events_lost;
  data.real_time = drilling.real_time;
  const auto count = [](std::size_t value) { return std::to_string(value); };
  for (const auto& [name, value] : figures.operator_words) data.figures.push_back({"Operator, " + name, value, ""});
  data.figures.push_back({"Spindle", fixed_text(figures.setup.options.spindle.rpm, 0), "rpm"});
  data.figures.push_back({"Engine", name_of(figures.setup.engine), ""});
  if (figures.setup.region_mm) data.figures.push_back({"Region", region_text(*figures.setup.region_mm), ""});
  if (drilling.left.voxels) {
    data.figures.insert(data.figures.end(), {{"Voxels", fixed_text(drilling.left.voxels->voxel_mm(), 3), "mm"},
                                             {"Voxels of bone", count(drilling.points_in_bone), ""},
                                             {"Voxels removed", count(drilling.removed), ""}});
  } else {
    data.figures.insert(data.figures.end(), {{"Discs", count(static_cast<std::size_t>(drilling.discs)), ""},
                                             {"Points per disc", count(drilling.points_per_disc), ""},
                                             {"Points in the cylinder", count(drilling.points), ""},
                                             {"Points in bone", count(drilling.points_in_bone), ""},
                                             {"Points removed", count(drilling.removed), ""}});
  }
  data.figures.insert(data.figures.end(), {{"Cycles", count(drilling.cycles), ""},
                                           {"Drilled for", fixed_text(drilling.session_s, 2), "s"}});
  if (!drilling.real_time) {
    const DrillRates rates = drill_rates(drilling.rows);
    data.figures.insert(data.figures.end(),
                        {{"Time of all cycles", fixed_text(drilling.seconds, 2), "s"},
                         {"Rate, first tenth of the path", fixed_text(rates.first_tenth, 0), "cycles/s"},
                         {"Rate, middle tenth", fixed_text(rates.middle_tenth, 0), "cycles/s"},
                         {"Rate, last tenth", fixed_text(rates.last_tenth, 0), "cycles/s"}});
  }
  data.figures.insert(
      data.figures.end(),
      {{"Max thrust", fixed_text(drilling.max_thrust_n, 2), "N"},
       {"Max thrust, 5 to 95 % of sources", interval_text(band.thrust_n(drilling.max_thrust_n), 2), "N"},
       {"Max torque", fixed_text(drilling.max_torque_n_mm, 1), "N·mm"},
       {"Max torque, 5 to 95 % of sources", interval_text(band.torque_n_mm(drilling.max_torque_n_mm), 1), "N·mm"},
       {"First bone at depth", fixed_text(drilling.entry_depth_mm, 2), "mm"},
       {"Drilled mesh, triangles", count(figures.mesh.triangles), ""},
       {"Drilled mesh, closed", figures.mesh.closed() ? "yes" : "no", ""},
       {"Drilled mesh, pieces", count(figures.mesh.pieces), ""},
       {"Loose chips left out", count(figures.chips.count), ""},
       {"Drilled mesh, volume", fixed_text(figures.mesh.volume_mm3 / 1000.0, 2), "cm³"}});
  if (const std::string words = end_words(drilling, figures.setup.path); !words.empty()) {
    data.figures.push_back({"Gave up", words, ""});
  }
  if (figures.setup.options.compliance.is_on) {
    data.figures.push_back({"Max way off, of the tip", fixed_text(drilling.max_off_mm, 2), "mm"});
  }
  if (drilling.max_contact_n > 0.0) {
    data.figures.push_back({"Max contact force, spindle off", fixed_text(drilling.max_contact_n, 2), "N"});
  }
  if (figures.setup.options.heat) data.heat_distance_mm = figures.setup.options.heat->distance_mm;
  if (figures.heat != nullptr) {
    const std::vector<ReportRow> rows = heat_rows(*figures.heat);
    data.figures.insert(data.figures.end(), rows.begin(), rows.end());
  }
  for (const std::string& warning : figures.bone.input_remarks()) data.notes.push_back("The CT: " + warning);
  if (const std::optional<LevelWarnings> marked = figures.bone.warnings()) {
    for (const std::string& warning : marked->warnings) {
      data.notes.push_back((marked->is_suspect() ? "This bone is SUSPECT: " : "The bone: ") + warning);
    }
  }
  if (figures.setup.has_clearances && !figures.bone.no_landmarks().empty()) {
    data.notes.push_back("No canal and no sides were found: " + figures.bone.no_landmarks());
  }
  if (figures.cycles_not_recorded > 0) {
    data.notes.push_back("The record lacks " + count(figures.cycles_not_recorded) + " cycles.");
  }
  return data;
}

std::string end_words(const Drilling& drilling, const DrillPath& path) {
  const std::string where =
      fixed_text(drilling.deepest_mm, 1) + " mm deep, of " + fixed_text(path.length_mm(), 1) + " mm";
  switch (drilling.operator_end) {
    case OperatorEnd::as_planned:
      return {};
    case OperatorEnd::broke_through:
      return where + ": the bone gave way, and a probe felt none at the end of the hole";
    case OperatorEnd::stood_still:
      return where + ": the bone held all of the push; push harder, or take a sharper or thinner bit";
    case OperatorEnd::ran_out_of_time:
      return where + ": it took too long";
    case OperatorEnd::device_lost:
      return where + ": its device was not heard of any more";
  }
  return {};
}

std::string region_text(const Box3& region_mm) {
  const auto corner = [](const Vec3& at) {
    return fixed_text(at.x(), 1) + ", " + fixed_text(at.y(), 1) + ", " + fixed_text(at.z(), 1);
  };
  return corner(region_mm.min()) + " to " + corner(region_mm.max()) + " mm";
}

void stage_drilling(const Drilling& drilling, const TriangleMesh& surface, const DrillReportData& data,
                    const std::filesystem::path& folder, StagedOutput& output) {
  output.write(folder / "log.csv", log_csv(drilling.rows));
  output.write(folder / "events.csv", events_csv(drilling.events));
  write_bone(drilling.drilled, output.stage(folder / "drilled.vdb"));
  write_mesh(surface, output.stage(folder / "drilled.stl"));
  output.write(folder / "report.html", drill_report(data));
}

std::map<std::string, std::string> record_words(const std::map<std::string, std::string>& operator_words,
                                                const std::string& pace) {
  std::map<std::string, std::string> words;
  for (const auto& [name, value] : operator_words) words["operator " + name] = value;
  words["pace"] = pace;
  return words;
}

}  // namespace spinaltap
