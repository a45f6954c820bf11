// Samples of the baked grids on one core, on the phantom of an L3 vertebra with voxels of 0.25 mm: tests of inside,
// tri-linear and tri-quadratic distances, beside OpenVDB's own samplers on the same grid through one accessor. Points
// are random, in no order: in the bone's box (0), or within the band of 3 voxels around its surface (1).

#include <benchmark/benchmark.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>

#include <cmath>
#include <random>
#include <vector>

#include "core/phantom/vertebra.h"
#include "vdb/bake/bake.h"
#include "vdb/detail/bone_grids.h"
#include "vdb/detail/bone_samplers.h"

namespace spinaltap {
namespace {

constexpr std::size_t kPoints = 1 << 20;
constexpr int kWithinBand = 1;

const BoneModel& bone() {
  static const BoneModel model = bake_solid(Vertebra(), {}, 40.0);
  return model;
}

std::vector<Vec3> random_points(bool within_band) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  const Box3 box_mm = bone().bounds_mm();
  std::vector<Vec3> points_mm;
  while (points_mm.size() < kPoints) {
    const Vec3 p_mm = box_mm.min() + Vec3(share(random), share(random), share(random)).cwiseProduct(box_mm.sizes());
    float distance_mm = 0.0F;
    bone().distance({&p_mm, 1}, {&distance_mm, 1}, {});
    if (!within_band || std::abs(static_cast<double>(distance_mm)) < 0.99 * bone().band_mm()) points_mm.push_back(p_mm);
  }
  return points_mm;
}

const std::vector<Vec3>& points(const benchmark::State& state) {
  static const std::vector<Vec3> in_box = random_points(false);
  static const std::vector<Vec3> in_band = random_points(true);
  return state.range(0) == kWithinBand ? in_band : in_box;
}

void count_points(benchmark::State& state) {
  state.counters["points_per_s"] =
      benchmark::Counter(static_cast<double>(kPoints), benchmark::Counter::kIsIterationInvariantRate);
}

void inside(benchmark::State& state) {
  const std::vector<Vec3>& points_mm = points(state);
  std::vector<std::uint8_t> result(kPoints);
  for (auto _ : state) {
    bone().inside(points_mm, result);
    benchmark::DoNotOptimize(result.data());
  }
  std::size_t within = 0;
  for (const std::uint8_t one : result) within += one;
  state.counters["share_inside"] = static_cast<double>(within) / static_cast<double>(kPoints);
  count_points(state);
}
BENCHMARK(inside)->ArgName("band")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

void distance(benchmark::State& state, Interpolation interpolation, bool with_gradient) {
  const std::vector<Vec3>& points_mm = points(state);
  std::vector<float> distance_mm(kPoints);
  std::vector<Vec3> gradients(with_gradient ? kPoints : 0);
  for (auto _ : state) {
    bone().distance(points_mm, distance_mm, gradients, interpolation);
    benchmark::DoNotOptimize(distance_mm.data());
  }
  count_points(state);
}
BENCHMARK_CAPTURE(distance, linear, Interpolation::linear, false)
    ->ArgName("band")
    ->Arg(0)
    ->Arg(1)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(distance, linear_with_gradient, Interpolation::linear, true)
    ->ArgName("band")
    ->Arg(0)
    ->Arg(1)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(distance, quadratic, Interpolation::quadratic, false)
    ->ArgName("band")
    ->Arg(0)
    ->Arg(1)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(distance, quadratic_with_gradient, Interpolation::quadratic, true)
    ->ArgName("band")
    ->Arg(0)
    ->Arg(1)
    ->Unit(benchmark::kMillisecond);

template <class Sampler>
void openvdb_sampler(benchmark::State& state) {
  const std::vector<Vec3>& points_mm = points(state);
  std::vector<float> distance_mm(kPoints);
  const openvdb::FloatGrid& grid = *bone().grids().sdf;
  for (auto _ : state) {
    const openvdb::FloatGrid::ConstAccessor accessor = grid.getConstAccessor();
    const openvdb::tools::GridSampler<openvdb::FloatGrid::ConstAccessor, Sampler> sampler(accessor, grid.transform());
    for (std::size_t i = 0; i < kPoints; ++i) distance_mm[i] = sampler.wsSample(detail::to_vdb(points_mm[i]));
    benchmark::DoNotOptimize(distance_mm.data());
  }
  count_points(state);
}
BENCHMARK_TEMPLATE(openvdb_sampler, openvdb::tools::BoxSampler)
    ->ArgName("band")
    ->Arg(0)
    ->Arg(1)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_TEMPLATE(openvdb_sampler, openvdb::tools::QuadraticSampler)
    ->ArgName("band")
    ->Arg(0)
    ->Arg(1)
    ->Unit(benchmark::kMillisecond);

/// What a BoneModel costs to make from its grids: the samplers' tables of blocks.
void make_tables(benchmark::State& state) {
  const detail::BoneGrids& grids = bone().grids();
  for (auto _ : state) benchmark::DoNotOptimize(detail::make_samplers(grids));
  state.counters["leaves"] = grids.sdf->tree().leafCount() + grids.hu->tree().leafCount();
}
BENCHMARK(make_tables)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace spinaltap

BENCHMARK_MAIN();
