// Grading a path, as a window does while its end is dragged: one core, on the phantom of an L3 vertebra baked with
// voxels of 0.25 mm, a screw of 6.5 mm by 45 mm on the left pedicle's path, shifted inward by the argument in mm: 0
// stays in the bone, 4 breaks through the canal's wall, 40 lies in the air on the other side.

#include <benchmark/benchmark.h>

#include <memory>

#include "core/plan/grade.h"
#include "tests/support/planning_bones.h"
#include "vdb/bake.h"
#include "vdb/bone_field.h"

namespace spinaltap {
namespace {

struct Bone {
  Vertebra vertebra;
  BoneModel model = bake_solid(vertebra, {}, 40.0);
  BoneShape shape{std::make_shared<BoneField>(model), model.bounds_mm(), model.voxel_mm()};
  Landmarks landmarks = test::phantom_landmarks(vertebra, shape);
  WallDistance walls{shape, landmarks};
};

const Bone& bone() {
  static const Bone made;
  return made;
}

DrillPath path(double inward_mm) {
  const PedicleTruth pedicle = vertebra_truth(bone().vertebra).left;
  const Vec3 inward = -inward_mm * Vec3::UnitX();
  DrillPath made{"left", pedicle.entry_mm + inward, pedicle.target_mm + inward, {}};
  made.screw = PedicleScrew{"", 6.5, 45.0, 4.0};
  return made;
}

void grade(benchmark::State& state) {
  const DrillPath graded_path = path(static_cast<double>(state.range(0)));
  const HuSampler hu = [](std::span<const Vec3> points_mm, std::span<float> values) {
    bone().model.hu(points_mm, values, {});
  };
  const Material material;
  double breach_mm = 0.0;
  std::size_t rows = 0;
  for (auto _ : state) {
    const PathGrade graded = grade_path(bone().walls, hu, material, graded_path);
    breach_mm = graded.breach_mm;
    rows = graded.rows.size();
  }
  state.counters["breach_mm"] = breach_mm;
  state.counters["rows"] = static_cast<double>(rows);
}
BENCHMARK(grade)->ArgName("inward_mm")->Arg(0)->Arg(4)->Arg(40)->Unit(benchmark::kMillisecond);

void walls(benchmark::State& state) {
  const DrillPath along = path(0.0);
  double sum_mm = 0.0;
  for (auto _ : state) {
    for (int n = 0; n <= 100; ++n) {
      sum_mm += bone().walls.walls(along.entry_mm + n / 100.0 * (along.target_mm - along.entry_mm)).nearer_mm();
    }
  }
  benchmark::DoNotOptimize(sum_mm);
  state.counters["walls_per_s"] = benchmark::Counter(101.0, benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(walls)->Unit(benchmark::kMicrosecond);

void make_walls(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(WallDistance(bone().shape, bone().landmarks));
}
BENCHMARK(make_walls)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace spinaltap

BENCHMARK_MAIN();
