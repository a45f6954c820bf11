// The bone as it is while it is drilled: the phantom of an L3 vertebra, the paper's path by hand (1 mm/s, tremor of
// 0.1 mm), 1,000 poses a second, frames of 1/60 s. For each frame the bit's way is taken away and the surface brought
// up to date; beside it, in the same run, the whole surface is meshed at once. One thread.

#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include <cmath>
#include <numbers>

#include "apps/spinaltap/bench/drill_workload.h"
#include "core/phantom/vertebra.h"
#include "core/session/real_time/timing.h"
#include "core/tool/drill_path.h"
#include "vdb/bake/bake.h"
#include "vdb/remaining/remaining_surface.h"

namespace spinaltap {
namespace {

const BoneModel& bone() {
  static const BoneModel model = bake_solid(Vertebra(), {}, 40.0);
  return model;
}

/// The paper's path, 37.8 mm long, through the phantom's left pedicle, by hand.
std::vector<Pose> tremor_poses() {
  const Vertebra vertebra;
  const auto& pedicle = vertebra.anatomy().pedicle;
  const double inward = pedicle.convergence_deg * std::numbers::pi / 180.0;
  const Vec3 along(-std::sin(inward), -std::cos(inward), 0.0);
  constexpr double kBeforeIsthmusMm = 14.0;
  const DrillPath path = workload_path(3.0);
  const PathFrame from(path.entry_mm, path.direction());
  const PathFrame to(vertebra.to_patient(pedicle.isthmus_mm - kBeforeIsthmusMm * along), vertebra.rotation() * along);
  std::vector<Pose> poses = workload_poses(WorkloadMotion::tremor);
  for (Pose& pose : poses) pose = to.to_patient(from.to_path(pose));
  return poses;
}

/// The argument is the voxel, um.
void drill_with_tremor(benchmark::State& state) {
  bone();
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const double voxel_mm = 1e-3 * static_cast<double>(state.range(0));
  const std::vector<Pose> poses = tremor_poses();
  const DrillBit bit = workload_path(3.0).bit;
  for (auto _ : state) {
    const std::int64_t begin_ns = thread_cpu_ns();
    RemainingBone remaining(bone(), {.voxel_mm = voxel_mm});
    state.counters["resample_s"] = 1e-9 * static_cast<double>(thread_cpu_ns() - begin_ns);
    RemainingSurface surface(remaining);
    std::vector<std::int64_t> cpu_ns;
    std::vector<std::int64_t> drill_cpu_ns;
    std::vector<std::int64_t> wall;
    std::size_t max_blocks = 0;
    constexpr double kPosesPerFrame = 1000.0 / 60.0;
    std::size_t at = 0;
    for (std::size_t frame = 1; at + 1 < poses.size(); ++frame) {
      const auto next = std::min(poses.size() - 1,
                                 static_cast<std::size_t>(std::lround(static_cast<double>(frame) * kPosesPerFrame)));
      const std::int64_t wall_before_ns = wall_ns();
      const std::int64_t before_ns = thread_cpu_ns();
      remaining.drill(bit, std::span(poses).subspan(at, next - at + 1));
      drill_cpu_ns.push_back(thread_cpu_ns() - before_ns);
      max_blocks = std::max(max_blocks, surface.update().size());
      cpu_ns.push_back(thread_cpu_ns() - before_ns);
      wall.push_back(wall_ns() - wall_before_ns);
      at = next;
    }
    const std::int64_t whole_before_ns = thread_cpu_ns();
    surface.rebuild();
    const double whole_ms = 1e-6 * static_cast<double>(thread_cpu_ns() - whole_before_ns);
    const TimeSpread cpu = spread_of(cpu_ns);
    state.counters["frames"] = static_cast<double>(cpu_ns.size());
    state.counters["cpu_p50_ms"] = 1e-3 * cpu.p50_us;
    state.counters["cpu_p99_ms"] = 1e-3 * cpu.p99_us;
    state.counters["cpu_max_ms"] = 1e-3 * cpu.max_us;
    state.counters["drill_p99_ms"] = 1e-3 * spread_of(drill_cpu_ns).p99_us;
    state.counters["wall_p50_ms"] = 1e-3 * spread_of(wall).p50_us;
    state.counters["wall_p99_ms"] = 1e-3 * spread_of(wall).p99_us;
    state.counters["whole_ms"] = whole_ms;
    state.counters["p99_of_whole"] = 1e-3 * cpu.p99_us / whole_ms;
    state.counters["max_blocks"] = static_cast<double>(max_blocks);
    state.counters["bone_MB"] = 1e-6 * static_cast<double>(remaining.memory_bytes());
    state.counters["undo_MB"] = 1e-6 * static_cast<double>(remaining.undo_memory_bytes());
    state.counters["surface_MB"] = 1e-6 * static_cast<double>(surface.memory_bytes());
    std::size_t triangles = 0;
    for (const auto& block : surface.blocks()) triangles += block->triangles.size();
    state.counters["triangles"] = static_cast<double>(triangles);
  }
}
BENCHMARK(drill_with_tremor)
    ->ArgName("voxel_um")
    ->Arg(200)
    ->Arg(100)
    ->Iterations(1)
    ->Unit(benchmark::kSecond)
    ->MeasureProcessCPUTime();

}  // namespace
}  // namespace spinaltap

BENCHMARK_MAIN();
