// The whole bone as voxels: how long filling it takes and what it weighs, and what a burr costs that turns. Millings in
// lines are measured by `spinaltap bench drill --motion milling`, on the same bone.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

#include "apps/spinaltap/bench/milling_workload.h"
#include "core/phantom/scanner.h"
#include "core/phantom/spine.h"
#include "tests/support/temporary_folder.h"
#include "vdb/bake/bake.h"
#include "vdb/engine/voxel_engine.h"
#include "vdb/sim/session.h"

namespace spinaltap {
namespace {

const std::filesystem::path& bone_file() {
  static const test::TemporaryFolder folder;
  static const std::filesystem::path file = [] {
    const std::filesystem::path path = folder.path() / "bone.vdb";
    write_bone(milling_bone(0.25), path);
    return path;
  }();
  return file;
}

void fill(benchmark::State& state) {
  const double voxel_mm = 1e-2 * static_cast<double>(state.range(0));
  const auto& file = bone_file();
  for ([[maybe_unused]] const auto _ : state) {
    const VoxelBone voxels(read_bone(file), {.voxel_mm = voxel_mm});
    state.counters["voxels"] = static_cast<double>(voxels.occupied_count());
    state.counters["tree_MB"] = 1e-6 * static_cast<double>(voxels.memory_bytes());
  }
}
BENCHMARK(fill)->Arg(10)->Arg(20)->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();

/// The phantom's L1 to L5 on one lattice, from their grids of 0.5 mm on.
void fill_spine(benchmark::State& state) {
  static const std::vector<BoneModel> bones = [] {
    SpineOptions options;
    options.first = Level::kL1;
    const Spine spine(options);
    std::vector<BoneModel> baked;
    for (std::size_t n = 0; n < spine.part_count(); ++n) {
      const SpinePart& part = spine.part(n);
      if (part.vertebra) baked.push_back(bake_solid(*part.vertebra, {.voxel_mm = 0.5}, ScanOptions().surroundings_hu));
    }
    return baked;
  }();
  const double voxel_mm = 1e-2 * static_cast<double>(state.range(0));
  for ([[maybe_unused]] const auto _ : state) {
    VoxelBone voxels(bones, {.voxel_mm = voxel_mm});
    state.PauseTiming();
    const auto engine = make_voxel_engine(voxels, milling_burr(4.0), {});
    state.counters["bones"] = static_cast<double>(bones.size());
    state.counters["voxels"] = static_cast<double>(voxels.occupied_count());
    state.counters["tree_MB"] = 1e-6 * static_cast<double>(voxels.memory_bytes());
    state.counters["with_engine_MB"] = 1e-6 * static_cast<double>(voxels.memory_bytes() + engine->memory_bytes());
    state.ResumeTiming();
  }
}
BENCHMARK(fill_spine)->Arg(20)->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();

/// How long `step` took at each pose, us.
template <class Step>
std::vector<double> step_times_us(const std::vector<Pose>& poses, const Step& step) {
  std::vector<double> times_us;
  times_us.reserve(poses.size());
  auto before = std::chrono::steady_clock::now();
  for (const Pose& pose : poses) {
    step(pose);
    const auto now = std::chrono::steady_clock::now();
    times_us.push_back(1e-3 * static_cast<double>((now - before).count()));
    before = now;
  }
  return times_us;
}

/// A burr that turns a degree a step about a place behind its tip (the tip is swept over bone) or its tip itself.
void turn(benchmark::State& state) {
  static const VoxelBone whole(read_bone(bone_file()), {.voxel_mm = 0.1});
  const DrillBit burr = milling_burr(4.0);
  const std::vector<Pose> poses = turning_poses(static_cast<double>(state.range(0)));
  std::vector<double> step_us;
  std::size_t removed = 0;
  for ([[maybe_unused]] const auto _ : state) {
    state.PauseTiming();
    VoxelBone bone(whole);
    const auto engine = make_voxel_engine(bone, burr, {}, {.shares_work = false});
    engine->step(poses.front());
    removed = 0;
    state.ResumeTiming();
    step_us = step_times_us(poses, [&](const Pose& pose) { removed += engine->step(pose).removed; });
  }
  std::ranges::sort(step_us);
  state.counters["median_us"] = step_us[step_us.size() / 2];
  state.counters["p99_us"] = step_us[step_us.size() * 99 / 100];
  state.counters["removed_per_step"] = static_cast<double>(removed) / static_cast<double>(poses.size());
}
// How far behind the tip it turns (mm).
BENCHMARK(turn)->Arg(50)->Arg(0)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

/// A saw of 12 x 1 mm that goes down 12 mm through the bone at 50 um a step, straight or in a hand that trembles by 0.2
/// mm and a thousandth of a radian.
void saw(benchmark::State& state) {
  const double trembles = static_cast<double>(state.range(0));
  static const VoxelBone whole(read_bone(bone_file()), {.voxel_mm = 0.1});
  const DrillBit blade = plate_bit(12.0, 1.0, 40.0, 4.0);
  const Vec3 start_mm = milling_start_mm() + Vec3(0.0, 0.0, 1.0);
  constexpr int kSteps = 260;
  std::vector<Pose> poses;
  for (int n = 0; n < kSteps; ++n) {
    const double a = 0.063 * n, b = 0.057 * n + 1.0, c = 0.071 * n + 2.0;  // 10 Hz at 1 kHz
    const Vec3 aside_mm = 0.2 * trembles * Vec3(std::sin(a), std::sin(b), 0.0);
    const Vec3 axis = Vec3(1e-3 * trembles * std::sin(c), 1e-3 * trembles * std::sin(b), -1.0).normalized();
    const Vec3 side = (Vec3::UnitY() - axis.y() * axis).normalized();
    poses.push_back({start_mm + aside_mm - 0.05 * n * Vec3::UnitZ(), axis, side});
  }
  std::vector<double> step_us;
  std::size_t removed = 0;
  for ([[maybe_unused]] const auto _ : state) {
    state.PauseTiming();
    VoxelBone bone(whole);
    const auto engine = make_voxel_engine(bone, blade, {}, {.shares_work = false});
    engine->step(poses.front());
    removed = 0;
    state.ResumeTiming();
    step_us = step_times_us(poses, [&](const Pose& pose) { removed += engine->step(pose).removed; });
  }
  double sum_us = 0.0;
  for (const double one_us : step_us) sum_us += one_us;
  std::ranges::sort(step_us);
  state.counters["steps_per_s"] = 1e6 * static_cast<double>(step_us.size()) / sum_us;
  state.counters["median_us"] = step_us[step_us.size() / 2];
  state.counters["p99_us"] = step_us[step_us.size() * 99 / 100];
  state.counters["removed_per_step"] = static_cast<double>(removed) / static_cast<double>(poses.size());
}
BENCHMARK(saw)->ArgName("trembles")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

/// A session that has milled for some seconds: to put the bone back, or to begin anew.
void put_back(benchmark::State& state) {
  const bool is_undone = state.range(0) == 1;
  const Bone bone(read_bone(bone_file()));
  const std::vector<Pose> poses = milling_poses({}, 5'000);
  const DrillPath path{"milling", poses.front().tip_mm, poses.front().tip_mm - 5.0 * Vec3::UnitZ(), milling_burr(4.0)};
  SessionSetup setup;
  setup.engine = EngineKind::voxel;
  setup.has_clearances = false;
  Session session(bone, path, setup);
  std::size_t removed = 0;
  for ([[maybe_unused]] const auto _ : state) {
    state.PauseTiming();
    removed = 0;
    for (const Pose& pose : poses) removed += session.step(pose).step.removed;
    state.ResumeTiming();
    if (is_undone) {
      session.undo();
    } else {
      session = Session(bone, path, setup);
    }
  }
  state.counters["removed"] = static_cast<double>(removed);
}
BENCHMARK(put_back)->ArgName("undone")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace spinaltap

BENCHMARK_MAIN();
