#include "apps/spinaltap/drill_run.h"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <deque>
#include <exception>
#include <optional>

#include "apps/report/drilling_report.h"
#include "apps/report/heat_figures.h"
#include "apps/report/picture_view.h"
#include "apps/report/session_report.h"
#include "apps/report/text.h"
#include "apps/report/text_table.h"
#include "apps/spinaltap/command.h"
#include "apps/spinaltap/further_bones.h"
#include "apps/spinaltap/input_warnings.h"
#include "apps/spinaltap/mesh_figures.h"
#include "apps/spinaltap/report_options.h"
#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "core/base/text_writer.h"
#include "core/files/bit_json.h"
#include "core/files/data_files.h"
#include "core/files/material_file.h"
#include "core/files/recorded_setup.h"
#include "core/force/force_band.h"
#include "core/points/neighbour_distances.h"
#include "core/rbf/rbf_field.h"
#include "core/rbf/rbf_file.h"
#include "core/session/choose_engine.h"
#include "core/session/record/session_record.h"
#include "mesh/cut_out.h"
#include "mesh/display_mesh.h"
#include "mesh/mesh_io.h"
#include "mesh/remaining_mesh.h"
#include "vdb/engine/points_file.h"
#include "vdb/engine/voxel_map.h"
#include "vdb/remaining/live_mesh.h"

namespace spinaltap {
namespace {

/// The furthest that the operator went after a stop or a breakthrough, mm; NaN where there was none.
double plunge_depth_mm(const std::vector<SessionEvent>& events) {
  double max_mm = std::nan("");
  for (const SessionEvent& event : events) {
    if (event.kind == EventKind::plunge) max_mm = std::fmax(max_mm, event.value);
  }
  return max_mm;
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
          {"warnings", run.warnings},
          {"collision", json_of(run.collision)},
          {"tool", json_of(run.tool)},
          {"display", json_of(run.display)},
          {"output", json_of(run.output)}};
}

Json json_of(const SessionEvent& event, const ForceBand& band) {
  Json json{
      {"event", name_of(event.kind)},
      {"cycle", event.cycle},
      {"time_s", event.time_s},
      {"depth_mm", number_or_null(event.depth_mm)},
      {"place_mm",
       {number_or_null(event.place_mm.x()), number_or_null(event.place_mm.y()), number_or_null(event.place_mm.z())}},
      {"value", number_or_null(event.value)}};
  if (event.kind == EventKind::stop_thrust) {
    json["p05_thrust_n"] = band.thrust_n(event.value).low;
    json["p95_thrust_n"] = band.thrust_n(event.value).high;
  }
  return json;
}

void print_rows(const TextRows& table) {
  std::vector<TextTable::Column> columns;
  for (const std::string& name : table.head) columns.push_back({name, "", !columns.empty()});
  TextTable text(std::move(columns));
  for (const std::vector<std::string>& row : table.rows) text.add_row(row);
  std::fputs(text.aligned().c_str(), stdout);
}

void print_events(const Drilling& drilling, const ForceBand& band) {
  constexpr std::size_t kMax = 24;
  for (std::size_t n = 0; n < std::min(drilling.events.size(), kMax); ++n) {
    const SessionEvent& event = drilling.events[n];
    std::printf(
        "  %9s s  at %7s mm  %-14s %s\n", fixed_text(event.time_s, 3).c_str(), fixed_text(event.depth_mm, 2).c_str(),
        std::string(name_of(event.kind)).c_str(),
        (value_text(event) + (event.kind == EventKind::stop_thrust && band.is_known()
                                  ? ", 5 to 95 % of sources " + interval_text(band.thrust_n(event.value), 1) + " N"
                                  : ""))
            .c_str());
  }
  const std::size_t further = drilling.events.size() + drilling.events_lost - std::min(drilling.events.size(), kMax);
  if (further > 0) std::printf("  and %zu further events: see events.csv\n", further);
}

/// A record of the session, where one is asked for.
class Recording {
 public:
  Recording(const DrillOptions& options, const SessionSetup& setup, const OperatorPlan& tool_operator) {
    if (options.record.empty()) return;
    const std::string pace = options.is_real_time ? "real time" : "as fast as it goes";
    std::map<std::string, std::string> words = record_setup(setup);
    words.merge(record_words(tool_operator.words, pace));
    writer_.emplace(options.record, words, options.may_replace_record, std::nullopt,
                    record_parts(setup.path.bit, setup.options));
  }
  RecordWriter* writer() { return writer_ ? &*writer_ : nullptr; }
  /// What goes wrong is kept: a full disk shall not cost the other results.
  void close(const std::vector<SessionEvent>& events) {
    if (!writer_) return;
    try {
      writer_->close(events);
    } catch (const Error&) {
      trouble_ = std::current_exception();
    }
  }
  /// Cycles that did not get into it.
  std::uint64_t lost() const { return writer_ ? writer_->lost() : 0; }
  void rethrow_trouble() const {
    if (trouble_) std::rethrow_exception(trouble_);
  }

 private:
  std::optional<RecordWriter> writer_;
  std::exception_ptr trouble_;
};

}  // namespace

void print_drilling(const DrillFigures& figures, const DensityCalibration& density) {
  const Drilling& drilling = figures.drilling;
  if (drilling.left.voxels) {
    print_figure("voxels of bone", static_cast<double>(drilling.points_in_bone), "", 0);
    print_figure("voxels removed", static_cast<double>(drilling.removed), "", 0);
    print_figure("memory", drilling.bytes_per_point, "bytes/voxel", 3);
  } else {
    print_figure("points in the cylinder", static_cast<double>(drilling.points), "", 0);
    print_figure("points in bone", static_cast<double>(drilling.points_in_bone), "", 0);
    print_figure("points removed", static_cast<double>(drilling.removed), "", 0);
    const NeighbourDistances neighbours = neighbour_distances(drilling.left.volumes.front(), false);
    print_figure("nearest neighbours, mean", neighbours.mean_mm, "mm", 4);
    print_figure("nearest neighbours, standard deviation", neighbours.deviation_mm, "mm", 4);
    print_figure("memory", drilling.bytes_per_point, "bytes/point", 3);
  }
  for (const auto& [name, value, unit] : tool_rows(figures.setup.path.bit)) {
    std::string label = name, shown = value;
    label.front() = static_cast<char>(label.front() - 'A' + 'a');
    shown.append(" ").append(unit);
    print_figure(label, shown);
  }
  print_figure("engine", name_of(figures.setup.engine));
  if (figures.setup.region_mm) print_figure("region", region_text(*figures.setup.region_mm));
  for (const auto& [name, value] : figures.operator_words) print_figure("operator, " + name, value);
  print_figure("cycles", static_cast<double>(drilling.cycles), "", 0);
  print_figure("drilled for", drilling.session_s, "s", 3);
  if (drilling.real_time) {
    for (const std::string& warning : drilling.real_time->warnings) print_figure("warning", warning);
    for (const TextRows& table : {pace_rows(*drilling.real_time), latency_rows(*drilling.real_time)}) print_rows(table);
  } else {
    const DrillRates rates = drill_rates(drilling.rows);
    print_figure("rate, first tenth of the path", rates.first_tenth, "cycles/s", 0);
    print_figure("rate, last tenth", rates.last_tenth, "cycles/s", 0);
  }
  const ForceBand band(figures.setup.material);
  const auto print_band = [&](const std::string& name, const Interval& of, const char* unit, int digits) {
    if (band.is_known()) print_figure(name + ", 5 to 95 % of sources", interval_text(of, digits) + " " + unit);
  };
  if (const std::string words = end_words(drilling, figures.setup.path); !words.empty()) print_figure("gave up", words);
  print_figure("max thrust", drilling.max_thrust_n, "N", 2);
  print_band("max thrust", band.thrust_n(drilling.max_thrust_n), "N", 2);
  print_figure("max torque", drilling.max_torque_n_mm, "N·mm", 1);
  print_band("max torque", band.torque_n_mm(drilling.max_torque_n_mm), "N·mm", 1);
  if (figures.setup.options.compliance.is_on) print_figure("max way off, of the tip", drilling.max_off_mm, "mm", 2);
  if (drilling.max_contact_n > 0.0) print_figure("max contact force, spindle off", drilling.max_contact_n, "N", 2);
  if (std::isfinite(drilling.min_clearance_outer_mm)) {
    print_figure("min clearance, outer surface", drilling.min_clearance_outer_mm, "mm", 2);
  }
  if (std::isfinite(drilling.min_clearance_canal_mm)) {
    print_figure("min clearance, canal", drilling.min_clearance_canal_mm, "mm", 2);
  }
  if (figures.setup.options.heat) {
    print_figure("max temperature beside the hole", drilling.heat.max_temperature_c, "°C", 1);
    print_figure("max temperature, at depth", drilling.heat.max_depth_mm, "mm", 1);
  }
  if (figures.heat != nullptr) print_heat(*figures.heat);
  print_figure("density at 0 HU", density.line.at_0_hu, "g/cm3", 4);
  print_figure("density per 1000 HU", 1000.0 * density.line.per_hu, "g/cm3", 4);
  if (density.rms_residual_g_cm3 > 0.0) {
    print_figure("calibration misses the line by", density.rms_residual_g_cm3, "g/cm3 rms", 4);
  }
  if (figures.setup.has_clearances && !figures.bone.no_landmarks().empty()) {
    print_figure("no canal found", figures.bone.no_landmarks());
  }
  if (figures.cycles_not_recorded > 0) {
    print_figure("cycles not recorded", static_cast<double>(figures.cycles_not_recorded), "", 0);
  }
  print_events(drilling, band);
}

Json drilling_json(const DrillFigures& figures, const DensityCalibration& density) {
  const Drilling& drilling = figures.drilling;
  const DrillPath& path = figures.setup.path;
  const ForceBand band(figures.setup.material);
  Json json{{"path", path.name},
            {"length_mm", path.length_mm()},
            {"operator", figures.operator_words},
            {"engine", name_of(figures.setup.engine)},
            {"bit", bit_json(path.bit)},
            {"unit", drilling.left.voxels ? "voxels" : "points"},
            {"removed", drilling.removed},
            {"cycles", drilling.cycles},
            {"session_s", drilling.session_s},
            {"max_depth_mm", number_or_null(drilling.deepest_mm)},
            {"max_thrust_n", drilling.max_thrust_n},
            {"p05_thrust_n", band.thrust_n(drilling.max_thrust_n).low},
            {"p95_thrust_n", band.thrust_n(drilling.max_thrust_n).high},
            {"max_contact_n", drilling.max_contact_n},
            {"max_torque_n_mm", drilling.max_torque_n_mm},
            {"p05_torque_n_mm", band.torque_n_mm(drilling.max_torque_n_mm).low},
            {"p95_torque_n_mm", band.torque_n_mm(drilling.max_torque_n_mm).high},
            {"max_off_mm", drilling.max_off_mm},
            {"min_clearance_outer_mm", number_or_null(drilling.min_clearance_outer_mm)},
            {"min_clearance_canal_mm", number_or_null(drilling.min_clearance_canal_mm)},
            {"stopped", drilling.is_stopped},
            {"operator_end", name_of(drilling.operator_end)},
            {"plunge_depth_mm", number_or_null(plunge_depth_mm(drilling.events))},
            {"events_lost", drilling.events_lost},
            {"cycles_not_recorded", figures.cycles_not_recorded},
            {"density_at_0_hu_g_cm3", density.line.at_0_hu},
            {"density_per_hu_g_cm3", density.line.per_hu},
            {"calibration_rms_g_cm3", density.rms_residual_g_cm3},
            {"calibration_max_g_cm3", density.max_residual_g_cm3},
            {"loose_chips", {{"count", figures.chips.count}, {"volume_mm3", figures.chips.volume_mm3}}},
            {"mesh", report_mesh(figures.mesh)}};
  if (figures.setup.region_mm) {
    json["region_mm"] = {to_json(figures.setup.region_mm->min()), to_json(figures.setup.region_mm->max())};
  }
  if (figures.setup.options.heat) {
    json["max_temperature_c"] = number_or_null(drilling.heat.max_temperature_c);
    json["max_temperature_depth_mm"] = number_or_null(drilling.heat.max_depth_mm);
  }
  if (figures.heat != nullptr) json["heat"] = heat_json(*figures.heat);
  if (figures.chips.count > 0) {
    print_figure("loose chips left out of the mesh",
                 std::to_string(figures.chips.count) + ", " + fixed_text(figures.chips.volume_mm3, 3) + " mm3");
  }
  if (drilling.left.voxels) {
    json["voxel_mm"] = drilling.left.voxels->voxel_mm();
    json["voxels_in_bone"] = drilling.points_in_bone;
    json["bytes_per_voxel"] = drilling.bytes_per_point;
  } else {
    const NeighbourDistances neighbours = neighbour_distances(drilling.left.volumes.front(), false);
    json["points"] = drilling.points;
    json["points_in_bone"] = drilling.points_in_bone;
    json["bytes_per_point"] = drilling.bytes_per_point;
    json["discs"] = drilling.discs;
    json["points_per_disc"] = drilling.points_per_disc;
    json["nearest_neighbours_mm"] = {{"min", neighbours.min_mm},
                                     {"mean", neighbours.mean_mm},
                                     {"deviation", neighbours.deviation_mm},
                                     {"max", neighbours.max_mm}};
  }
  Json events = Json::array();
  for (const SessionEvent& event : drilling.events) events.push_back(json_of(event, band));
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

Json run_drill(const DrillPage& page, std::span<const Bone> bones, const DrillPath& path, const DrillOptions& options,
               const std::filesystem::path& folder, StagedOutput& output, StageClock& clock, const Progress& progress) {
  options.check(path.bit);
  SessionSetup setup = options.setup;
  setup.path = path;
  setup.has_clearances = !options.leaves_clearances && !options.tool_operator.is_milling();
  setup.region_mm = options.region_mm(path);
  const Bone& bone = bones.front();
  if (bones.size() > 1 || !options.record.empty()) name_bones(setup, bones);
  const FieldOfBones whole(bones);
  OperatorChoice choice = options.tool_operator;
  choice.longest_s = options.seconds;
  setup.options.has_device = choice.has_device();
  OperatorPlan tool_operator =
      choice.plan(path, setup.volume.lead_in_mm, setup.options.spindle, options.is_real_time, &whole);
  setup = setup_for(std::move(setup), tool_operator.way);
  const DensityCalibration density =
      read_density_calibration(options.density.empty() ? data_file("densities/vertebra.json") : options.density);
  setup.material =
      read_material(options.material.empty() ? data_file("materials/vertebra.json") : options.material, density.line);
  if (options.has_heat) {
    setup.options.heat = options.heat.options();
    if (options.heat_limit_c) setup.options.heat->limit_c = *options.heat_limit_c;
  }
  std::optional<RbfField> field;
  if (!options.field.empty()) field.emplace(RbfField::for_values(read_rbf(options.field), RbfField::kDefaultAccuracy));
  Recording recording(options, setup, tool_operator);
  DrillingOptions how{.exact = field ? &*field : nullptr,
                      .log_step_mm = options.log_step_mm,
                      .real_time = options.real_time(tool_operator),
                      .makes_splats = options.writes_splats,
                      .record = recording.writer()};
  // Beside the drilling, as a simulator shows it; where the clock does not count, nobody looks.
  std::deque<LiveMesh> live;
  if (how.real_time) {
    for (const Bone& one : bones) live.emplace_back(one.model(), path.bit, setup.options.max_jump_mm);
    how.display = [&live, &setup](const Cycle& cycle) {
      for (LiveMesh& mesh : live) mesh.update(cutting_input(cycle, setup.options));
    };
  }
  const Drilling drilling = drill_bone(bones, setup, *tool_operator.tool_operator, how, progress);
  recording.close(drilling.events);
  std::optional<SolvedHeat> heat;
  if (options.solves_heat) heat.emplace(solve_heat(drilling.before, setup, drilling.heat_steps, {}, progress));
  clock.end("drilled");
  const auto mesh_of = [&](const BoneModel& drilled) {
    return options.writes_full_mesh ? sharp_surface(drilled) : display_mesh(drilled, {}, nullptr, progress);
  };
  // Neither needs the other.
  TriangleMesh surface;
  LooseChips chips;
  MeshQuality quality;
  std::vector<ReportPicture> pictures;
  tbb::parallel_invoke(
      [&] {
        surface = mesh_of(drilling.drilled);
        chips = drop_loose_chips(surface);
        quality = measure_mesh(surface);
      },
      [&] {
        if (!options.leaves_pictures) pictures = drill_pictures(drilling.before, drilling.drilled, path, progress);
      });
  clock.end("meshed and drawn");
  const DrillFigures figures{
      drilling, bone, setup, tool_operator.words, quality, chips, recording.lost(), heat ? &*heat : nullptr};
  DrillReportData data = report_data(page.title, page.ct, figures);
  data.command = page.command;
  data.notes.insert(data.notes.end(), page.notes.begin(), page.notes.end());
  data.date = today();
  data.renders = std::move(pictures);

  stage_drilling(drilling, surface, data, folder, output);
  if (heat) heat->grid->write(output.stage(folder / "heat.vdb"), heat->heat.bone.temperature_c);
  const std::vector<std::string> further = names_of_further(bones);
  for (std::size_t n = 0; n < further.size(); ++n) {
    const std::string name = "drilled_" + further[n];
    write_bone(drilling.further_drilled[n], output.stage(folder / (name + ".vdb")));
    TriangleMesh its_surface = mesh_of(drilling.further_drilled[n]);
    drop_loose_chips(its_surface);
    write_mesh(its_surface, output.stage(folder / (name + ".stl")));
  }
  for (std::size_t n = 0; options.writes_points && n < drilling.left.volumes.size(); ++n) {
    const std::string number = drilling.left.volumes.size() == 1 ? "" : "_" + std::to_string(n + 1);
    write_points(drilling.left.volumes[n], path, output.stage(folder / ("points" + number + ".vdb")),
                 {.density = density.line});
  }
  if (options.writes_voxels) {
    const std::filesystem::path map = folder / "voxels.nii.gz";
    output.write(map, encode_label_volume(voxel_map(*drilling.left.voxels), map));
  }
  if (options.writes_splats) {
    output.write(folder / "splats.ply", splats_ply(drilling.splats));
    const DiscPattern& pattern = drilling.left.volumes.front().pattern();
    const double radius_mm = (pattern.ring_count() - 0.5) * pattern.spacing_mm();  // that the points stand for
    write_mesh(cut_out_cylinder(bone.model(), path, radius_mm, setup.volume.lead_in_mm),
               output.stage(folder / "around.ply"));
  }
  output.list_in(folder);
  output.commit();
  clock.end("written");

  print_drilling(figures, density);
  for (const std::string& name : further)
    print_figure("also drilled", (folder / ("drilled_" + name + ".vdb")).string());
  print_figure("report", (folder / "report.html").string());
  recording.rethrow_trouble();
  Json json = drilling_json(figures, density);
  report_bone_warnings(bone.model(), json);
  for (const std::string& name : further) json["also_drilled"].push_back("drilled_" + name + ".vdb");
  return json;
}

}  // namespace spinaltap
