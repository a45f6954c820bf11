// The whole bone as voxels: how long filling it takes and what it weighs, and how many steps a second a burr in a hand
// that trembles mills, bare and with forces. The phantom of an L3 vertebra in voxels of 0.1 mm, milled from its upper
// endplate: lines of 14 mm, 1 mm apart, in layers of 1 mm, at 50 mm/s and 1 kHz, with a tremor of 0.1 mm at 8 to 12 Hz;
// tilted burrs lie so in the plane of the lines. Steps are timed one by one, on one thread: `p99.9_us` is of single
// steps.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

#include "core/force/drill_forces.h"
#include "core/phantom/vertebra.h"
#include "tests/support/temporary_folder.h"
#include "vdb/engine/living_voxels.h"
#include "vdb/engine/voxel_engine.h"
#include "vdb/sim/phantom_output.h"

namespace spinaltap {
namespace {

const std::filesystem::path& bone_file() {
  static const test::TemporaryFolder folder;
  static const std::filesystem::path file = [] {
    PhantomOptions options;
    options.scan.columns = options.scan.rows = 64;
    options.scan.slices = 16;
    const Vertebra vertebra;
    write_phantom(vertebra, {}, options, folder.path() / "phantom");
    return folder.path() / "phantom" / "ground_truth.vdb";
  }();
  return file;
}

void fill(benchmark::State& state) {
  const double voxel_mm = 1e-2 * static_cast<double>(state.range(0));
  const auto& file = bone_file();
  for ([[maybe_unused]] const auto _ : state) {
    const VoxelBone voxels(read_bone(file), {.voxel_mm = voxel_mm});
    state.counters["voxels"] = static_cast<double>(voxels.alive_count());
    state.counters["tree_MB"] = 1e-6 * static_cast<double>(voxels.memory_bytes());
  }
}
BENCHMARK(fill)->Arg(10)->Arg(20)->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();

const VoxelBone& whole_bone(double voxel_mm) {
  static std::map<double, VoxelBone> bones;
  const auto found = bones.find(voxel_mm);
  return found != bones.end()
             ? found->second
             : bones.emplace(voxel_mm, VoxelBone(read_bone(bone_file()), {.voxel_mm = voxel_mm})).first->second;
}

/// Where the upper endplate is, above the middle of the body.
Vec3 endplate_mm(const VoxelBone& bone) {
  Vec3 low = Vec3::Constant(1e9), high = -low;
  bone.for_each_alive([&](const Eigen::Vector3i& voxel) {
    low = low.cwiseMin(bone.centre_mm(voxel));
    high = high.cwiseMax(bone.centre_mm(voxel));
  });
  // The body is the front of it.
  const Vec3 inside(0.5 * (low.x() + high.x()), low.y() + 16.0, 0.5 * (low.z() + high.z()));
  Eigen::Vector3i voxel = (inside / bone.voxel_mm()).array().round().matrix().cast<int>();
  int top = voxel.z();
  for (int z = top; bone.centre_mm({0, 0, z}).z() < high.z(); ++z) {
    if (bone.is_alive({voxel.x(), voxel.y(), z})) top = z;
  }
  return {inside.x(), inside.y(), bone.voxel_mm() * top};
}

/// Poses of the burr's tip and axis, `step_mm` apart but for what the hand trembles.
std::vector<Pose> milling(const Vec3& start_mm, double step_mm, double tilt, std::size_t count) {
  constexpr double kLineMm = 14.0, kApartMm = 1.0, kDeepMm = 1.0, kSpeedMmS = 50.0;
  constexpr int kLines = static_cast<int>(kLineMm / kApartMm);
  // The corners of one line to and fro after the other, layer by layer.
  std::vector<Vec3> corners{Vec3::Zero()};
  for (int line = 0; corners.size() < 1000; ++line) {
    const Vec3& at = corners.back();
    corners.push_back({at.x() > 0.0 ? 0.0 : kLineMm, at.y(), at.z()});
    const int layer = line / kLines;
    const bool ends_layer = line % kLines == kLines - 1;
    const double aside = layer % 2 == 0 ? kApartMm : -kApartMm;
    corners.push_back(corners.back() + (ends_layer ? Vec3(0.0, 0.0, -kDeepMm) : Vec3(0.0, aside, 0.0)));
  }
  const Vec3 first_mm = start_mm - Vec3(0.5 * kLineMm, 0.5 * kLineMm, kDeepMm);
  std::vector<Pose> poses;
  std::size_t next = 1;
  double begin_mm = 0.0;  // of the way to the corner before
  for (std::size_t n = 0; n < count; ++n) {
    const double way_mm = step_mm * static_cast<double>(n);
    double length_mm = (corners[next] - corners[next - 1]).norm();
    while (way_mm > begin_mm + length_mm) {
      begin_mm += length_mm;
      ++next;
      length_mm = (corners[next] - corners[next - 1]).norm();
    }
    const Vec3 at = corners[next - 1] + (way_mm - begin_mm) / length_mm * (corners[next] - corners[next - 1]);
    const auto wave = [&](double hz) { return 0.1 * std::sin(2.0 * std::numbers::pi * hz * way_mm / kSpeedMmS); };
    poses.push_back(
        {first_mm + at + Vec3(wave(8.1), wave(9.7), wave(11.9)), Vec3(std::sin(tilt), 0.0, -std::cos(tilt))});
  }
  return poses;
}

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

void mill(benchmark::State& state) {
  const double diameter_mm = static_cast<double>(state.range(0));
  const double step_mm = 1e-3 * static_cast<double>(state.range(1));
  const double tilt = static_cast<double>(state.range(2)) * kDegree;
  const VoxelBone& whole = whole_bone(1e-2 * static_cast<double>(state.range(3)));
  const bool has_forces = state.range(4) != 0;
  const DrillBit burr{diameter_mm, 60.0, 1.0, BitShape::round_burr, 0.0, 0.5 * diameter_mm};
  const auto poses = milling(endplate_mm(whole), step_mm, tilt, 60'000);
  std::vector<double> step_us;
  std::size_t removed = 0, tested = 0, bytes = 0;
  for ([[maybe_unused]] const auto _ : state) {
    state.PauseTiming();
    VoxelBone bone(whole);
    const auto engine = make_voxel_engine(bone, burr, {}, {.shares_work = false});
    const auto living = make_living_bone(bone, {});
    DrillForces forces(*living, burr, {});
    engine->step(poses.front());
    bytes = bone.memory_bytes() + engine->memory_bytes();
    removed = tested = 0;
    state.ResumeTiming();
    step_us = step_times_us(poses, [&](const Pose& pose) {
      const StepResult result = engine->step(pose);
      if (has_forces) benchmark::DoNotOptimize(forces.update(result, pose, 1e-3, {.rpm = 60e3}));
      removed += result.removed;
      tested += result.tested;
    });
  }
  std::ranges::sort(step_us);
  state.counters["steps_per_s"] =
      benchmark::Counter(static_cast<double>(poses.size()), benchmark::Counter::kIsIterationInvariantRate);
  state.counters["p99.9_us"] = step_us[step_us.size() * 999 / 1000];
  state.counters["MB"] = 1e-6 * static_cast<double>(bytes);
  state.counters["removed_per_step"] = static_cast<double>(removed) / static_cast<double>(poses.size());
  state.counters["tested_per_step"] = static_cast<double>(tested) / static_cast<double>(poses.size());
}
// Diameter (mm), step (um), tilt (degrees), voxel (0.01 mm), with forces.
BENCHMARK(mill)
    ->Args({4, 50, 0, 10, 0})
    ->Args({4, 50, 0, 10, 1})
    ->Args({4, 50, 30, 10, 0})
    ->Args({4, 50, 80, 10, 0})
    ->Args({4, 10, 0, 10, 0})
    ->Args({3, 50, 0, 10, 0})
    ->Args({6, 50, 0, 10, 0})
    ->Args({4, 50, 0, 20, 0})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();

/// A burr that swings from -5 to 5 degrees and back, a degree a step, about a place behind its tip (the tip is swept
/// over bone) or its tip itself, and goes 0.1 mm aside after each swing.
void turn(benchmark::State& state) {
  const auto behind_mm = static_cast<double>(state.range(0));
  const VoxelBone& whole = whole_bone(0.1);
  const DrillBit burr{4.0, 60.0, 1.0, BitShape::round_burr, 0.0, 2.0};
  const Vec3 start_mm = endplate_mm(whole) - Vec3(0.0, 6.0, 1.0);
  constexpr int kHalfSwing = 5, kSwings = 120;
  std::vector<Pose> poses;
  for (int swing = 0; swing < kSwings; ++swing) {
    for (int n = -kHalfSwing; n < kHalfSwing; ++n) {
      const double angle = (swing % 2 == 0 ? n : -n) * kDegree;
      const Vec3 axis(std::sin(angle), 0.0, -std::cos(angle));
      poses.push_back({start_mm + Vec3(0.0, 0.1 * swing, 0.0) + behind_mm * (axis + Vec3::UnitZ()), axis});
    }
  }
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

}  // namespace
}  // namespace spinaltap

BENCHMARK_MAIN();
