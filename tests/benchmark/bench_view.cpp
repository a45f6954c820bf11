// What a camera sees of a drilling: the phantom of an L3 vertebra, a path of 37.8 mm through its left pedicle, drilled
// straight and by an operator with a tremor of 0.1 mm; depth, normals and mask of all of the bone, and of 20 mm around
// the entry, where every pixel shows something. All threads; real time is that of a frame.

#include <benchmark/benchmark.h>

#include <cmath>
#include <numbers>

#include "apps/spinaltap/bench/drill_workload.h"
#include "core/phantom/vertebra.h"
#include "core/tool/drill_path.h"
#include "vdb/bake/bake.h"
#include "vdb/picture/view.h"
#include "vdb/remaining/hole_cutter.h"

namespace spinaltap {
namespace {

const BoneModel& bone() {
  static const BoneModel model = bake_solid(Vertebra(), {}, 40.0);
  return model;
}

/// The paper's path, moved into the phantom's left pedicle.
std::vector<ToolInput> inputs(WorkloadMotion motion) {
  const Vertebra vertebra;
  const auto& pedicle = vertebra.anatomy().pedicle;
  const double inward = pedicle.convergence_deg * std::numbers::pi / 180.0;
  const Vec3 along(-std::sin(inward), -std::cos(inward), 0.0);
  constexpr double kBeforeIsthmusMm = 14.0;
  const DrillPath path = workload_path(3.0);
  const PathFrame from(path.entry_mm, path.direction());
  const PathFrame to(vertebra.to_patient(pedicle.isthmus_mm - kBeforeIsthmusMm * along), vertebra.rotation() * along);
  std::vector<ToolInput> moved;
  for (const Pose& pose : workload_poses(motion)) moved.push_back({to.to_patient(from.to_path(pose)), true, 0.001});
  return moved;
}

/// Arguments: width in pixels; 1: from near; 1: by hand.
void view_frame(benchmark::State& state) {
  constexpr double kFieldOfView = 0.5;
  constexpr double kNearMm = 20.0;
  constexpr double kLongestJumpMm = 50.0;
  const auto width = static_cast<int>(state.range(0));
  const std::vector<ToolInput> drilled = inputs(state.range(2) == 1 ? WorkloadMotion::tremor : WorkloadMotion::on_path);
  const DrillBit bit = workload_path(3.0).bit;
  HoleCutter cutter(bone());
  cutter.take_bit(bit, kLongestJumpMm);
  cutter.add(drilled);
  // Half out again, so that hole and bit are seen.
  const Pose& deepest = drilled.back().pose;
  const RenderedBit shown_bit{bit, {deepest.tip_mm - 30.0 * deepest.axis, deepest.axis}};
  const Vec3 entry_mm = drilled.front().pose.tip_mm;
  const Vec3 target_mm = state.range(1) == 1 ? entry_mm : bone().bounds_mm().center();
  const double width_mm = state.range(1) == 1 ? kNearMm : bone().bounds_mm().diagonal().norm();
  const Vec3 from = (Vec3(0.3, 0.0, 0.6) - deepest.axis).normalized();
  const Camera camera = look_at(target_mm + 0.5 * width_mm / std::tan(0.5 * kFieldOfView) * from, target_mm,
                                Vec3::UnitZ(), kFieldOfView, width, width * 3 / 4);
  std::size_t shown = 0;
  for (auto _ : state) {
    const View view = view_bone(cutter.hole(), camera, shown_bit);
    shown = 0;
    for (const std::uint8_t seen : view.mask) shown += seen != 0 ? 1U : 0U;
  }
  state.counters["shown"] = static_cast<double>(shown) / static_cast<double>(width * (width * 3 / 4));
}
/// What a frame in the middle of a drilling costs more: 40 cycles, cut out. Argument: 1: by hand.
void cut_frame(benchmark::State& state) {
  constexpr std::size_t kCyclesAFrame = 40;
  const std::vector<ToolInput> drilled = inputs(state.range(0) == 1 ? WorkloadMotion::tremor : WorkloadMotion::on_path);
  HoleCutter cutter(bone());
  cutter.take_bit(workload_path(3.0).bit, 50.0);
  std::size_t done = drilled.size() / 2;
  cutter.add(std::span(drilled).first(done));
  for (auto _ : state) {
    cutter.add(std::span(drilled).subspan(done, kCyclesAFrame));
    done += kCyclesAFrame;
    benchmark::DoNotOptimize(cutter.hole().hole.get());
  }
}
BENCHMARK(cut_frame)
    ->ArgName("tremor")
    ->Arg(0)
    ->Arg(1)
    ->Iterations(200)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->MeasureProcessCPUTime();
BENCHMARK(view_frame)
    ->ArgNames({"width", "near", "tremor"})
    ->ArgsProduct({{320, 640}, {0, 1}, {0, 1}})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->MeasureProcessCPUTime();

}  // namespace
}  // namespace spinaltap

BENCHMARK_MAIN();
