#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <fstream>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/python/arrays.h"
#include "apps/python/bindings.h"
#include "apps/python/long_call.h"
#include "apps/python/names.h"
#include "core/base/staged_output.h"
#include "core/files/recorded_setup.h"
#include "core/files/thermal_bone_file.h"
#include "core/session/drill_state.h"
#include "core/session/record/session_record.h"
#include "vdb/sim/replay.h"
#include "vdb/sim/solve_heat.h"

namespace py = pybind11;
using namespace py::literals;

namespace spinaltap {

namespace {

template <class Kind>
py::tuple names_to(Kind last) {
  py::list names;
  for (int n = 0; n <= static_cast<int>(last); ++n) {
    const std::string name(name_of(static_cast<Kind>(n)));
    names.append(name.empty() ? std::to_string(n) : name);  // a number that is not taken
  }
  return py::tuple(names);
}

template <class Write>
void save_csv(const SessionRecord& record, const std::filesystem::path& file, const Write& write) {
  StagedOutput output;
  const std::filesystem::path staged = output.stage(file);
  std::ofstream csv(staged, std::ios::binary);
  write(record, csv);
  if (!csv.flush()) fail_as(ErrorKind::disk, file.string(), ": cannot be written; is the disk full?");
  csv.close();
  output.commit();
}

std::optional<EngineKind> engine_of(const std::string& name) {
  return name.empty() ? std::nullopt : std::optional(named(engine_kinds(), name, "an engine"));
}

}  // namespace

void bind_record(py::module_& module) {
  module.attr("CYCLE") = cycle_dtype();
  module.attr("EVENT") = event_dtype();
  module.attr("EVENT_KINDS") = names_to(EventKind::tool_change);
  module.attr("STATES") = names_to(DrillState::inner_cortical);

  py::class_<SessionRecord>(module, "Record", "A record read back; docs/record-file.md.")
      .def_readonly("setup", &SessionRecord::setup, "All that decided what the session did, as text.")
      .def_property_readonly(
          "cycles",
          [](const py::object& self) {
            const auto& record = self.cast<const SessionRecord&>();
            return py::array(cycle_dtype(), {record.cycles.size()}, {}, record.cycles.data(), self);
          },
          "A row for each cycle, of dtype CYCLE; shows the record's own memory.")
      .def_property_readonly(
          "events",
          [](const py::object& self) {
            const auto& record = self.cast<const SessionRecord&>();
            return py::array(event_dtype(), {record.events.size()}, {}, record.events.data(), self);
          },
          "A row for each event, of dtype EVENT; shows the record's own memory.")
      .def_readonly("is_whole", &SessionRecord::is_whole, "It was closed in order.")
      .def_readonly("frame_count", &SessionRecord::frame_count, "Of what cameras saw: read_frames().")
      .def_readonly("lost", &SessionRecord::lost, "Cycles that did not get into it.")
      .def_property_readonly(
          "hash", [](const SessionRecord& record) { return hash_of(record); },
          "A fingerprint of all cycles and events, to the last bit.")
      .def(
          "write_csv",
          [](const SessionRecord& record, const std::filesystem::path& file) {
            save_csv(record, file, write_record_csv);
          },
          "file"_a, py::call_guard<py::gil_scoped_release>(), "A row for each cycle.")
      .def(
          "write_events_csv",
          [](const SessionRecord& record, const std::filesystem::path& file) {
            save_csv(record, file, write_events_csv);
          },
          "file"_a, py::call_guard<py::gil_scoped_release>(), "A row for each event.");
  module.def("read_record", &read_record, "file"_a, py::call_guard<py::gil_scoped_release>(),
             "Also while it is being written, and after a kill. Raises Error on a file that is no record, or damaged.");

  py::class_<SolvedHeat>(module, "SolvedHeat", "How warm the bone got around a drilling's hole; docs/heat.md.")
      .def_readonly("hottest_c", &SolvedHeat::hottest_c)
      .def_property_readonly("hottest_mm", [](const SolvedHeat& heat) { return array_of(heat.hottest_mm); })
      .def_readonly("hottest_depth_mm", &SolvedHeat::hottest_depth_mm, "Along the path: 0 at the entry.")
      .def_property_readonly(
          "distances",
          [](const SolvedHeat& heat) {
            std::vector<std::pair<double, double>> rows;
            for (const HeatAtDistance& away : heat.distances) rows.emplace_back(away.distance_mm, away.temperature_c);
            return rows;
          },
          "Millimetres from the wall, and the hottest bone so far away or further, °C.")
      .def_property_readonly(
          "above_47c_60s_mm3", [](const SolvedHeat& heat) { return heat.harmed_mm3[0]; },
          "Bone that was hotter than 47 °C for 60 s in all.")
      .def_property_readonly(
          "above_50c_30s_mm3", [](const SolvedHeat& heat) { return heat.harmed_mm3[1]; },
          "Bone that was hotter than 50 °C for 30 s in all.")
      .def(
          "save",
          [](const SolvedHeat& heat, const std::filesystem::path& file) {
            StagedOutput output;
            heat.grid->write(output.stage(file), heat.heat.bone.temperature_c);
            output.commit();
          },
          "file"_a, py::call_guard<py::gil_scoped_release>(),
          "Writes a .vdb with max_temperature, °C, and seconds_hot_0 and _1, s above 47 and 50 °C.");
  module.def(
      "solve_heat",
      [](const std::filesystem::path& record, const Bone& bone, const std::optional<bool>& irrigation,
         const std::filesystem::path& thermal_bone, double voxel_mm, const py::object& progress) {
        return long_call(progress, [&](const Progress& heard) {
          const SessionRecord drilled = read_record(record);
          SolveHeatOptions options;
          options.voxel_mm = voxel_mm;
          options.heat = recorded_setup(drilled.setup, record).options.heat;
          if (!options.heat) options.heat = HeatOptions{.bone = shipped_thermal_bone()};
          if (!thermal_bone.empty()) options.heat->bone = read_thermal_bone(thermal_bone);
          if (irrigation) options.heat->is_irrigated = *irrigation;
          return solve_heat(drilled, record, bone, options, heard);
        });
      },
      "record"_a, "bone"_a, py::kw_only(), "irrigation"_a = py::none(), "thermal_bone"_a = "", "voxel_mm"_a = 0.2,
      "progress"_a = py::none(),
      "How warm the bone got around a recorded drilling's hole, solved on a grid. What is not given is as the record "
      "has "
      "it, else dry and with the shipped bone. Raises Error where it is another bone.");

  py::class_<Replay>(module, "Replay", "What running a record again came to.")
      .def_readonly("cycles", &Replay::cycles)
      .def_readonly("events", &Replay::events)
      .def_readonly("seconds", &Replay::seconds)
      .def_readonly("difference", &Replay::difference, "The first; empty: every bit is the same.")
      .def_readonly("gap", &Replay::gap, "Where the record lacks cycles; empty: nowhere.")
      .def_property_readonly("is_same", &Replay::is_same);
  module.def(
      "replay",
      [](const std::filesystem::path& record, const Bone& bone, const std::string& engine, const py::object& progress,
         const std::vector<Bone>& also, bool other_ct) {
        const std::optional<EngineKind> kind = engine_of(engine);
        std::vector<Bone> bones{bone};
        bones.insert(bones.end(), also.begin(), also.end());
        return long_call(progress, [&](const Progress& heard) {
          return replay(read_record(record), record, bones, kind, heard, other_ct);
        });
      },
      "record"_a, "bone"_a, "engine"_a = "", "progress"_a = py::none(), "also"_a = std::vector<Bone>(),
      "other_ct"_a = false,
      "Runs a record again on the bone that it was drilled in, and those beside it, and compares every bit. other_ct: "
      "take another bone all the same.");
}

}  // namespace spinaltap
