// Planning on the phantom of an L3 vertebra baked with voxels of 0.25 mm. auto_plan is all that `plan --auto` does but
// reading the file, on all cores; its stages follow. grade is what a window does while a path's end is dragged, on one
// core: a screw of 6.5 mm by 45 mm on the left pedicle's path, shifted inward by the argument in mm: 0 stays in the
// bone, 4 breaks through the canal's wall, 40 lies in the air on the other side. grade_screws is what a study without
// drilling does with 10,000 such screws, 1.5 mm and 2.9 degrees off their plan (each of two normal): screws a second on
// one core.

#include <benchmark/benchmark.h>

#include <cstdint>
#include <memory>
#include <vector>

#include "core/anatomy/bone_shape.h"
#include "core/grading/screw_breach.h"
#include "core/phantom/vertebra_ground_truth.h"
#include "core/uncertainty/placement_errors.h"
#include "vdb/bake/bake.h"
#include "vdb/grid/bone_field.h"
#include "vdb/grid/bone_model.h"
#include "vdb/sim/auto_plan.h"
#include "vdb/sim/bone.h"

namespace spinaltap {
namespace {

const BoneModel& model() {
  static const BoneModel made = bake_solid(Vertebra(), {}, 40.0);
  return made;
}

const Bone& bone() {
  static const Bone made(model());
  return made;
}

DrillPath path(double inward_mm) {
  const PedicleGroundTruth pedicle = vertebra_ground_truth(Vertebra()).left;
  const Vec3 inward = -inward_mm * Vec3::UnitX();
  DrillPath made{"left", pedicle.entry_mm + inward, pedicle.target_mm + inward, {}};
  made.screw = PedicleScrew{"", 6.5, 45.0, 4.0};
  return made;
}

void plan_both_sides(benchmark::State& state) {
  model();
  std::size_t ways = 0;
  for (auto _ : state) {
    const Bone planned(model());
    ways = auto_plan(planned.walls(), planned.hu_sampler())[0].best.value().trajectories_tried;
  }
  state.counters["ways_a_side"] = static_cast<double>(ways);
}
BENCHMARK(plan_both_sides)->Name("auto_plan")->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();

void make_shape(benchmark::State& state) {
  for (auto _ : state) {
    benchmark::DoNotOptimize(BoneShape(std::make_shared<BoneField>(model()), model().bounds_mm(), model().voxel_mm()));
  }
}
BENCHMARK(make_shape)->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();

void make_landmarks(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(find_landmarks(bone().shape()));
}
BENCHMARK(make_landmarks)->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();

void suggest(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(auto_plan(bone().walls(), bone().hu_sampler()));
}
BENCHMARK(suggest)->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();

void grade(benchmark::State& state) {
  const DrillPath graded_path = path(static_cast<double>(state.range(0)));
  const HuSampler hu = bone().hu_sampler();
  const Material material;
  double breach_mm = 0.0;
  std::size_t rows = 0;
  for (auto _ : state) {
    const PathGrade graded = grade_path(bone().walls(), hu, material, graded_path);
    breach_mm = graded.breach_mm;
    rows = graded.rows.size();
  }
  state.counters["breach_mm"] = breach_mm;
  state.counters["rows"] = static_cast<double>(rows);
}
BENCHMARK(grade)->ArgName("inward_mm")->Arg(0)->Arg(4)->Arg(40)->Unit(benchmark::kMillisecond);

void grade_screws(benchmark::State& state) {
  constexpr std::uint32_t kScrews = 10'000;
  const ErrorFrame frame = error_frame(bone().landmarks(), path(0.0));
  const PlacementErrors errors = plain_errors(1.5, 2.9);
  std::vector<DrillPath> erred;
  for (std::uint32_t n = 0; n < kScrews; ++n) erred.push_back(erred_path(path(0.0), frame, draw_error(errors, 1, n)));
  const ScrewGrader grader(bone().walls());
  std::size_t breaches = 0;
  for (auto _ : state) {
    breaches = 0;
    for (const DrillPath& graded : erred) {
      if (grader.grade(graded, ScrewSides::anterior).breach_mm > 0.0) ++breaches;
    }
  }
  state.counters["breaches_percent"] = 100.0 * static_cast<double>(breaches) / kScrews;
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * kScrews);
}
BENCHMARK(grade_screws)->Unit(benchmark::kMillisecond);

void walls(benchmark::State& state) {
  const DrillPath along = path(0.0);
  double sum_mm = 0.0;
  for (auto _ : state) {
    for (int n = 0; n <= 100; ++n) {
      sum_mm += bone().walls().walls(along.entry_mm + n / 100.0 * (along.target_mm - along.entry_mm)).nearer_mm();
    }
  }
  benchmark::DoNotOptimize(sum_mm);
  state.counters["walls_per_s"] = benchmark::Counter(101.0, benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(walls)->Unit(benchmark::kMicrosecond);

void make_walls(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(WallDistance(bone().shape(), bone().landmarks()));
}
BENCHMARK(make_walls)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace spinaltap

BENCHMARK_MAIN();
