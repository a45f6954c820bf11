#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <string>
#include <vector>

#include "apps/python/bindings.h"
#include "apps/python/drill_task.h"
#include "apps/python/long_call.h"
#include "apps/python/one_at_a_time.h"

namespace py = pybind11;
using namespace py::literals;

namespace spinaltap {

namespace {

using OwnedTask = OneAtATime<DrillTask>;
using Actions = py::array_t<float, py::array::c_style | py::array::forcecast>;

constexpr py::ssize_t kWidth = DrillTask::kObservations.size();

template <class T>
std::span<T> all_of(py::array_t<T>& array) {
  return {array.mutable_data(), static_cast<std::size_t>(array.size())};
}

std::unique_ptr<OwnedTask> make_task(const std::vector<std::pair<Bone, DrillPath>>& holes, std::size_t count,
                                     int threads, const py::dict& options, const py::object& progress) {
  DrillTaskOptions task;
  const auto take = [&options](const char* name, auto& value) {
    if (options.contains(name)) value = options.attr("pop")(name).cast<std::remove_reference_t<decltype(value)>>();
  };
  take("cycles_per_step", task.cycles_a_step);
  take("dt_s", task.dt_s);
  take("max_steps", task.max_steps);
  take("max_feed_mm_s", task.max_feed_mm_s);
  take("max_aside_mm_s", task.max_aside_mm_s);
  take("max_turn_deg_s", task.max_turn_deg_s);
  take("start_mm", task.start_mm);
  take("start_offset_mm", task.start_offset_mm);
  take("start_tilt_deg", task.start_tilt_deg);
  take("margin_mm", task.margin_mm);
  take("margin_cost", task.margin_cost_s);
  take("target_reward", task.target_reward);
  take("breach_penalty", task.breach_penalty);
  take("radius_mm", task.radius_mm);
  take("spacing_mm", task.spacing_mm);
  for (const auto& [name, value] : options) {
    throw py::type_error("unexpected option \"" + std::string(py::str(name)) + "\" of a drill task");
  }
  std::vector<BonePath> paths;
  paths.reserve(holes.size());
  for (const auto& [bone, path] : holes) paths.push_back({bone, path});
  return std::make_unique<OwnedTask>(
      long_call(progress, [&](const Progress& heard) { return DrillTask(paths, count, task, threads, heard); }));
}

py::array_t<float> reset_all(OwnedTask& self, const std::vector<std::optional<std::uint64_t>>& seeds) {
  const auto task = self.take();
  py::array_t<float> observations({static_cast<py::ssize_t>(task->count()), kWidth});
  const std::span<float> to = all_of(observations);
  const py::gil_scoped_release unlocked;
  task->reset(seeds, to);
  return observations;
}

/// Shows the task's own memory, and keeps the task.
py::array_t<double> time_drillings(const py::object& self) {
  const std::span<const double> cpu_s = self.cast<OwnedTask&>().take()->time_drillings();
  return py::array_t<double>(static_cast<py::ssize_t>(cpu_s.size()), cpu_s.data(), self);
}

py::tuple step_all(OwnedTask& self, const Actions& actions, bool resets) {
  const auto task = self.take();
  const std::size_t count = task->count();
  if (static_cast<std::size_t>(actions.size()) != count * DrillTask::kActions) {
    fail("expected ", DrillTask::kActions, " actions for each of ", count, " drillings, found ", actions.size(),
         " numbers");
  }
  py::array_t<float> observations({static_cast<py::ssize_t>(count), kWidth});
  py::array_t<float> last({resets ? static_cast<py::ssize_t>(count) : 0, kWidth});
  py::array_t<double> rewards(static_cast<py::ssize_t>(count)), clearances(rewards.size()), thrusts(rewards.size());
  py::array_t<bool> terminated(rewards.size()), truncated(rewards.size()), breached(rewards.size());
  const DrillTask::Step to{all_of(observations), all_of(rewards),    all_of(terminated), all_of(truncated),
                           all_of(breached),     all_of(clearances), all_of(thrusts),    all_of(last)};
  const std::span<const float> given(actions.data(), static_cast<std::size_t>(actions.size()));
  {
    const py::gil_scoped_release unlocked;
    task->step(given, to);
  }
  return py::make_tuple(observations, rewards, terminated, truncated, breached, clearances, thrusts, last);
}

}  // namespace

void bind_drill_task(py::module_& module) {
  py::list names;
  for (const std::string_view name : DrillTask::kObservations) names.append(std::string(name));
  py::class_<OwnedTask>(module, "DrillTask", "What spinaltap.env stands on: use that.")
      .def(py::init(&make_task), "holes"_a, "count"_a, "threads"_a, "options"_a, "progress"_a = py::none())
      .def("__len__", [](OwnedTask& self) { return self.take()->count(); })
      .def("reset", &reset_all, "seeds"_a, "Begins a new episode of each, and gives their first observations.")
      .def("step", &step_all, "actions"_a, "resets"_a,
           "Observations, rewards, terminated, truncated, breached, min clearances (mm), max thrusts (N), and, "
           "where episodes begin again by themselves, the last observations of those before.")
      .def("time_drillings", &time_drillings,
           "An array that each step() fills: seconds of processor time of each drilling.")
      .def_property_readonly_static("ACTIONS", [](const py::object&) { return DrillTask::kActions; })
      .def_property_readonly_static("OBSERVATIONS", [names = py::tuple(names)](const py::object&) { return names; });
}

}  // namespace spinaltap
