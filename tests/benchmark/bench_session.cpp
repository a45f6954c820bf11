// What a cycle of a Session takes, one by one and in whole arrays: what Python's is compared with (bench_python.py).
// Drills the phantom in the folder that SPINALTAP_PYTHON_TEST_DATA names; `spinaltap phantom FOLDER` makes it.
#include <benchmark/benchmark.h>

#include <cstdlib>
#include <filesystem>
#include <vector>

#include "core/files/data_files.h"
#include "core/files/material_file.h"
#include "core/files/plan_file.h"
#include "core/force/drill_forces.h"
#include "core/session/operator/path_motion.h"
#include "vdb/engine/make_engine.h"
#include "vdb/grid/bone_model.h"
#include "vdb/sim/drilled_bone.h"
#include "vdb/sim/session.h"

namespace spinaltap {
namespace {

/// The same as bench_python.py's: along the left pedicle at 10 mm/s and 1 kHz.
struct Drilling {
  explicit Drilling(const std::filesystem::path& folder)
      : path(read_plan(folder / "plan.json").front()), session(Bone::load(folder / "ground_truth.vdb"), path) {
    PathMotionOptions options{.line = {.lead_in_mm = 3.0}};
    options.feed.steps = {{0.0, 10.0}};
    const PathMotion motion(path, options);
    for (std::size_t n = 0; n <= motion.cycle_count(); ++n) inputs.push_back({motion.pose(n), true, 0.001});
  }
  DrillPath path;
  Session session;
  std::vector<ToolInput> inputs;
};

template <class Drill>
void measure(benchmark::State& state, const Drill& drill) {
  const char* const folder = std::getenv("SPINALTAP_PYTHON_TEST_DATA");
  if (folder == nullptr) return state.SkipWithError("SPINALTAP_PYTHON_TEST_DATA names no folder");
  Drilling drilling(folder);
  for ([[maybe_unused]] const auto _ : state) {
    drill(drilling);
    state.PauseTiming();
    drilling.session.undo();
    state.ResumeTiming();
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(drilling.inputs.size()));
}

void steps(benchmark::State& state) {
  measure(state, [](Drilling& drilling) {
    for (const ToolInput& input : drilling.inputs) {
      const Cycle* cycle = &drilling.session.step_input(input);
      benchmark::DoNotOptimize(cycle);
    }
  });
}
BENCHMARK(steps)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

void arrays(benchmark::State& state) {
  measure(state, [](Drilling& drilling) { benchmark::DoNotOptimize(drilling.session.run(drilling.inputs)); });
}
BENCHMARK(arrays)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

/// The cycles of the same drilling, with forces and without: what forces and their band cost is the difference.
/// 20 times as fast as a hand drills, so that each cycle cuts.
void cycles(benchmark::State& state, bool has_forces) {
  const char* const folder = std::getenv("SPINALTAP_PYTHON_TEST_DATA");
  if (folder == nullptr) return state.SkipWithError("SPINALTAP_PYTHON_TEST_DATA names no folder");
  const Drilling drilling(folder);
  SessionSetup setup;
  setup.path = drilling.path;
  setup.engine = EngineKind::ring;
  setup.material = read_material(data_file("materials/vertebra.json"),
                                 read_density_calibration(data_file("densities/vertebra.json")).line);
  const DrilledBone whole(read_bone(std::filesystem::path(folder) / "ground_truth.vdb"), setup);
  DrilledBone bone = whole;
  const std::unique_ptr<DrillEngine> engine =
      make_engine(setup.engine, bone.volumes.front(), setup.path.bit, setup.material);
  DrillForces forces(bone.volumes, setup.path.bit, setup.material);
  for ([[maybe_unused]] const auto _ : state) {
    for (const ToolInput& input : drilling.inputs) {
      StepResult result = engine->step(input.pose);
      if (has_forces) {
        benchmark::DoNotOptimize(forces.update(result, input.pose, input.dt_s, Spindle()));
      } else {
        benchmark::DoNotOptimize(result);
      }
    }
    state.PauseTiming();
    bone.revive(whole);
    engine->reset_motion();
    forces.reset();
    state.ResumeTiming();
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(drilling.inputs.size()));
}
BENCHMARK_CAPTURE(cycles, without_forces, false)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(cycles, with_forces, true)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

}  // namespace
}  // namespace spinaltap

BENCHMARK_MAIN();
