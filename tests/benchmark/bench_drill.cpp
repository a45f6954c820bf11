// The reference engine on the standard workload: a solid cylinder of radius 3 mm, 378 discs of 2,611 points, 0.1 mm
// apart (986,958 points), drilled in lock-step by 0.001 mm a cycle.
//
// For bits of 3.0 mm (whose wall lies on a ring of points) and 3.06 mm (between two), moving on the path, off it by
// 1.2 mm, and tilted to it by 3 degrees: time a cycle in the middle of the first, fifth and last tenth of the path. The
// bit is brought there in steps of 0.05 mm, which remove the same points; then 300 cycles are timed.
// Counters: cycles_per_s (of CPU time), removed and tested points a cycle, bytes a point.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <vector>

#include "core/drill/drill_engine.h"
#include "core/sim/lock_step.h"

namespace spinaltap {
namespace {

struct Motion {
  const char* name;
  double offset_mm;
  double tilt_deg;
};

constexpr double kPathMm = 37.8;
constexpr int kCycles = 300;

PointVolume solid_cylinder(const DrillPath& path) {
  PointVolume volume(path, {.radius_mm = 3.0, .spacing_mm = 0.1});
  constexpr std::int16_t kHu = 300;
  std::fill(volume.hu().begin(), volume.hu().end(), kHu);
  return volume;
}

void drill(benchmark::State& state, double diameter_mm, const Motion& motion_kind, double share_of_path) {
  // Oblique and far from the origin, as in a patient.
  const Vec3 entry(31.0, 212.0, -618.0);
  const DrillPath path{
      "standard", entry, entry + kPathMm * Vec3(-0.3, -0.93, 0.2).normalized(), {diameter_mm, 50.0, 5.0}};
  PointVolume volume = solid_cylinder(path);
  if (volume.point_count() != 986'958) {
    state.SkipWithError("expected 986,958 points");
    return;
  }
  const auto engine = make_reference_engine(volume, path.bit, Material());
  const LockStepMotion motion(path, 0.0,
                              {.step_mm = 0.001, .offset_mm = motion_kind.offset_mm, .tilt_deg = motion_kind.tilt_deg});
  const auto first = static_cast<std::size_t>(share_of_path * static_cast<double>(motion.cycle_count())) - kCycles / 2;
  constexpr std::size_t kStride = 50;
  for (std::size_t index = 0; index < first; index += kStride) engine->step(motion.pose(index));
  engine->step(motion.pose(first));

  std::vector<Pose> poses;
  for (std::size_t i = 1; i <= kCycles; ++i) poses.push_back(motion.pose(first + i));
  std::size_t next = 0;
  std::size_t removed = 0;
  std::size_t tested = 0;
  for (auto _ : state) {
    const StepResult result = engine->step(poses[next++]);
    removed += result.removed;
    tested += result.tested;
  }
  const auto cycles = static_cast<double>(state.iterations());
  state.counters["cycles_per_s"] = benchmark::Counter(cycles, benchmark::Counter::kIsRate);
  state.counters["removed"] = static_cast<double>(removed) / cycles;
  state.counters["tested"] = static_cast<double>(tested) / cycles;
  state.counters["bytes_per_point"] = static_cast<double>(volume.alive().size_bytes() + volume.hu().size_bytes()) /
                                      static_cast<double>(volume.point_count());
}

void register_all() {
  constexpr Motion kMotions[] = {{"on_path", 0.0, 0.0}, {"off_path_1.2mm", 1.2, 0.0}, {"tilted_3deg", 0.0, 3.0}};
  constexpr std::pair<const char*, double> kPlaces[] = {
      {"first_tenth", 0.05}, {"middle_tenth", 0.5}, {"last_tenth", 0.95}};
  constexpr std::pair<const char*, double> kBits[] = {{"3.00mm", 3.0}, {"3.06mm", 3.06}};
  for (const auto& [bit_name, diameter_mm] : kBits) {
    for (const Motion& motion : kMotions) {
      for (const auto& [place_name, share] : kPlaces) {
        const std::string name = std::string("reference/") + bit_name + "/" + motion.name + "/" + place_name;
        benchmark::RegisterBenchmark(name.c_str(),
                                     [diameter_mm = diameter_mm, motion, share = share](benchmark::State& state) {
                                       drill(state, diameter_mm, motion, share);
                                     })
            ->Iterations(kCycles)
            ->Unit(benchmark::kMicrosecond);
      }
    }
  }
}

}  // namespace
}  // namespace spinaltap

int main(int argc, char** argv) {
  spinaltap::register_all();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
