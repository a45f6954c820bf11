// What a cycle of a Session takes, one by one and in whole arrays: what Python's is compared with (bench_python.py).
// Drills the phantom in the folder that SPINALTAP_PYTHON_TEST_DATA names; `spinaltap phantom FOLDER` makes it.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/files/data_files.h"
#include "core/files/material_file.h"
#include "core/files/plan_file.h"
#include "core/force/drill_forces.h"
#include "core/session/operator/path_motion.h"
#include "core/session/real_time/timing.h"
#include "tests/support/count_allocations.h"
#include "tests/support/memory_used.h"
#include "vdb/engine/make_engine.h"
#include "vdb/grid/bone_model.h"
#include "vdb/sim/build_session.h"
#include "vdb/sim/drilled_bone.h"
#include "vdb/sim/session.h"
#include "vdb/sim/spinaltap_c.h"

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
    bone.restore(whole);
    engine->reset_motion();
    forces.reset();
    state.ResumeTiming();
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(drilling.inputs.size()));
}
BENCHMARK_CAPTURE(cycles, without_forces, false)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(cycles, with_forces, true)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

/// A hand at a burr, which trembles and goes about in the pedicle and the body, for an hour at 1 kHz: the memory that a
/// Session takes on the way, whether its steps allocate, and its cycles beside a bare DrillSession's, in turn.
/// `is_live`: the surface's changes are taken 30 times a second.
void hour(benchmark::State& state, bool is_live) {
  const char* const folder = std::getenv("SPINALTAP_PYTHON_TEST_DATA");
  if (folder == nullptr) return state.SkipWithError("SPINALTAP_PYTHON_TEST_DATA names no folder");
  const std::filesystem::path data(folder);
  const Bone bone = Bone::load(data / "ground_truth.vdb");
  SessionSetup setup;
  setup.path = read_plan(data / "plan.json").front();
  setup.path.bit = {4.0, 60.0, 2.0, BitShape::round_burr, 0.0, 2.5};
  setup.volume.spacing_mm = 0.2;
  setup.engine = EngineKind::voxel;
  setup.options.follows_path = false;
  setup.has_clearances = false;
  const Tremor tremor(0.1, 1);
  const Vec3 middle_mm = 0.5 * (setup.path.entry_mm + setup.path.target_mm);
  const Vec3 along = setup.path.direction(), aside = along.cross(Vec3::UnitZ()).normalized(), up = aside.cross(along);
  const auto input = [&](std::size_t n) {
    const double time_s = 0.001 * static_cast<double>(n);
    const Vec3 slow_mm = (2.0 + 20.0 * std::sin(0.011 * time_s)) * along + 7.0 * std::sin(0.13 * time_s) * aside +
                         5.0 * std::cos(0.07 * time_s) * up;
    return ToolInput{{middle_mm + slow_mm + tremor.at_mm(time_s), along}, true, 0.001};
  };
  for ([[maybe_unused]] const auto _ : state) {
    Session session(bone, setup.path, setup);
    BuiltSession bare = build_session(bone, session.setup());
    std::map<std::array<int, 3>, std::shared_ptr<const SurfaceBlock>> blocks;
    const auto take = [&] {
      for (SurfaceUpdate& change : session.surface_changes()) blocks[change.block] = std::move(change.surface);
    };
    if (is_live) take();
    const auto count = static_cast<std::size_t>(state.range(0));
    std::vector<std::int32_t> session_ns(count), bare_ns(count);
    std::vector<double> memory_mb{1e-6 * static_cast<double>(test::resident_bytes())};
    std::size_t allocations = 0;
    for (std::size_t n = 0; n < count; ++n) {
      const ToolInput now = input(n);
      const std::size_t before = test::allocation_count();
      const std::int64_t begin_ns = wall_ns();
      session.step_input(now);
      const std::int64_t between_ns = wall_ns();
      bare.session->step(now);
      bare_ns[n] = static_cast<std::int32_t>(wall_ns() - between_ns);
      session_ns[n] = static_cast<std::int32_t>(between_ns - begin_ns);
      allocations += test::allocation_count() - before;
      if (is_live && n % 33 == 32) take();
      if (n % 36'000 == 0) memory_mb.push_back(1e-6 * static_cast<double>(test::resident_bytes()));
    }
    const auto quantile_us = [count](std::vector<std::int32_t>& all_ns, double part) {
      const auto at = all_ns.begin() + static_cast<std::ptrdiff_t>(part * static_cast<double>(count - 1));
      std::nth_element(all_ns.begin(), at, all_ns.end());
      return 1e-3 * *at;
    };
    state.counters["allocations"] = static_cast<double>(allocations);
    state.counters["memory_MB"] = *std::ranges::max_element(memory_mb) - memory_mb.front();
    state.counters["off_mm"] = session.motion_off_mm();
    state.counters["p50_us"] = quantile_us(session_ns, 0.5);
    state.counters["p50_bare_us"] = quantile_us(bare_ns, 0.5);
    state.counters["p999_us"] = quantile_us(session_ns, 0.999);
    state.counters["p999_bare_us"] = quantile_us(bare_ns, 0.999);
  }
}
BENCHMARK_CAPTURE(hour, , false)->Arg(3'600'000)->Iterations(1)->Unit(benchmark::kSecond);
BENCHMARK_CAPTURE(hour, with_live_surface, true)->Arg(3'600'000)->Iterations(1)->Unit(benchmark::kSecond);

/// What a step costs more through the C interface than through C++: blocks of steps beside the bone, where a cycle is
/// shortest, in turn.
void c_interface(benchmark::State& state) {
  const char* const folder = std::getenv("SPINALTAP_PYTHON_TEST_DATA");
  if (folder == nullptr) return state.SkipWithError("SPINALTAP_PYTHON_TEST_DATA names no folder");
  constexpr int kBlocks = 1001, kSteps = 1000;
  const std::string file = std::filesystem::path(folder) / "ground_truth.vdb";
  SessionSetup setup;
  setup.has_clearances = false;
  setup.volume.spacing_mm = 0.3;
  Session direct(std::vector{Bone::load(file)}, setup);
  spinaltap_session_options options{};
  options.struct_bytes = sizeof options;
  spinaltap_session_options_default(&options);
  options.has_clearances = 0;
  options.spacing_mm = 0.3;
  spinaltap_bone* bone = nullptr;
  spinaltap_session* through_c = nullptr;
  if (spinaltap_bone_load(file.c_str(), &bone, nullptr) != SPINALTAP_OK ||
      spinaltap_session_new(&bone, 1, nullptr, &options, &through_c, nullptr) != SPINALTAP_OK) {
    return state.SkipWithError("the C interface makes no session");
  }
  const Vec3 away_mm = direct.bone().model().bounds_mm().max() + Vec3::Constant(40.0);
  for ([[maybe_unused]] const auto _ : state) {
    std::vector<double> more_ns, direct_ns;
    spinaltap_input input{};
    input.struct_bytes = sizeof input;
    input.spindle_on = 1;
    input.dt_s = 0.001;
    input.axis[2] = 1.0;
    spinaltap_cycle cycle{};
    cycle.struct_bytes = sizeof cycle;
    for (int block = 0; block < kBlocks; ++block) {
      const std::int64_t begin_ns = wall_ns();
      for (int n = 0; n < kSteps; ++n) {
        const Cycle* done = &direct.step_input({{away_mm + 0.001 * n * Vec3::UnitX(), Vec3::UnitZ()}, true, 0.001});
        benchmark::DoNotOptimize(done);
      }
      const std::int64_t between_ns = wall_ns();
      for (int n = 0; n < kSteps; ++n) {
        input.tip_mm[0] = away_mm.x() + 0.001 * n;
        input.tip_mm[1] = away_mm.y();
        input.tip_mm[2] = away_mm.z();
        spinaltap_session_step(through_c, &input, &cycle);
        benchmark::DoNotOptimize(cycle);
      }
      direct_ns.push_back(static_cast<double>(between_ns - begin_ns) / kSteps);
      more_ns.push_back(static_cast<double>(wall_ns() - between_ns) / kSteps - direct_ns.back());
    }
    const auto median = [](std::vector<double>& values) {
      std::nth_element(values.begin(), values.begin() + kBlocks / 2, values.end());
      return values[kBlocks / 2];
    };
    state.counters["direct_ns"] = median(direct_ns);
    state.counters["more_ns"] = median(more_ns);
  }
  spinaltap_session_free(through_c);
  spinaltap_bone_free(bone);
}
BENCHMARK(c_interface)->Iterations(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace spinaltap

BENCHMARK_MAIN();
