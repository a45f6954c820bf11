#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <vector>

#include "apps/python/arrays.h"
#include "apps/python/bindings.h"
#include "apps/python/long_call.h"
#include "vdb/sim/study.h"

namespace py = pybind11;
using namespace py::literals;

namespace spinaltap {

namespace {

py::array merged(const std::vector<std::filesystem::path>& folders) {
  std::vector<StudyRow> rows = [&folders] {
    const py::gil_scoped_release unlocked;
    const StudyTable table = merge(folders);
    std::vector<StudyRow> read;
    read.reserve(table.rows.size());
    for (const auto& [run, text] : table.rows) read.push_back(read_study_csv(text));
    return read;
  }();
  return array_of(std::move(rows));
}

}  // namespace

void bind_study(py::module_& module) {
  module.attr("STUDY") = study_dtype();
  py::class_<Study>(module, "Study", "A path drilled many times, with errors, on all cores; docs/studies.md.")
      .def_static(
          "load", [](const std::filesystem::path& spec) { return Study::load(spec); }, "spec"_a,
          py::call_guard<py::gil_scoped_release>(), "From a SPEC.json. Raises Error that names the key at fault.")
      .def("__len__", &Study::run_count, "How many runs it has.")
      .def_property_readonly(
          "hash", [](const Study& study) { return study.identity().hash(); }, "Of all that the results depend on.")
      .def_property_readonly(
          "bone", [](const Study& study) { return study.bone(); }, "The first, where there are several.")
      .def(
          "run",
          [](const Study& study, std::size_t shard, std::size_t shards, const py::object& progress) {
            return array_of(long_call(progress, [&](const Progress& heard) {
              return study.run({shard, shards}, heard);
            }));
          },
          py::kw_only(), "shard"_a = 1, "shards"_a = 1, "progress"_a = py::none(),
          "The rows, of dtype STUDY, in the order of their numbers; `grade` counts from 0, A. Of one of `shards` "
          "shards: "
          "the same rows in any. Ctrl-C cancels.")
      .def(
          "run_into",
          [](const Study& study, const std::filesystem::path& folder, std::size_t shard, std::size_t shards,
             const py::object& progress) {
            return long_call(progress,
                             [&](const Progress& heard) {
                               return study.run_into(folder, {shard, shards}, heard);
                             })
                .runs;
          },
          "folder"_a, py::kw_only(), "shard"_a = 1, "shards"_a = 1, "progress"_a = py::none(),
          "As run(), into a folder that keeps each finished run whatever happens: called again it goes on where it "
          "was. "
          "Gives how many runs it did now.");
  module.def("merge", &merged, "folders"_a,
             "The finished runs of shards' folders, of dtype STUDY. Raises Error on folders of different studies.");
}

}  // namespace spinaltap
