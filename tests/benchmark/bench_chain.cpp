// What comes before drilling, on the phantom of an L3 vertebra: evaluating a radial basis function of 3,800 centres,
// baking one (voxels of 0.25 mm), filling the standard volume of 986,958 points from the grids, and meshing.

#include <benchmark/benchmark.h>

#include <cmath>

#include "core/phantom/vertebra_ground_truth.h"
#include "core/points/point_volume.h"
#include "core/rbf/fit_surface.h"
#include "tests/support/surface_distance.h"
#include "vdb/bake/bake.h"
#include "vdb/grid/isosurface.h"

namespace spinaltap {
namespace {

SurfacePoints true_surface() {
  const Vertebra vertebra;
  SurfacePoints surface;
  surface.positions_mm = test::true_surface_points(vertebra, 0.5, 0.01);
  surface.normals.resize(surface.positions_mm.size());
  std::vector<double> values(surface.positions_mm.size());
  vertebra.evaluate(surface.positions_mm, values, surface.normals);
  for (Vec3& normal : surface.normals) normal.normalize();
  return surface;
}

const SurfacePoints& surface() {
  static const SurfacePoints points = true_surface();
  return points;
}

const RbfField& rbf() {
  static const RbfField field = fit_surface(surface()).field;
  return field;
}

const BoneModel& bone() {
  static const BoneModel model = bake_solid(Vertebra(), {}, 40.0);
  return model;
}

CtVolume even_ct() {
  const Box3 box = Vertebra().bounds_mm();
  GridGeometry geometry;
  geometry.spacing_mm = Vec3(0.352, 0.352, 0.5);
  geometry.origin_mm = box.min() - Vec3::Constant(5.0);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto at = static_cast<Eigen::Index>(axis);
    geometry.size[axis] = static_cast<int>(std::ceil((box.sizes()[at] + 10.0) / geometry.spacing_mm[at]));
  }
  return make_ct_volume(geometry, std::vector<std::int16_t>(geometry.voxel_count(), 300));
}

void evaluate_rbf(benchmark::State& state) {
  const bool with_gradient = state.range(0) != 0;
  constexpr std::size_t kPoints = 16384;
  const RbfField& field = rbf();
  const std::span<const Vec3> points_mm(surface().positions_mm.data(), kPoints);
  std::vector<double> values(kPoints);
  std::vector<Vec3> gradients(with_gradient ? kPoints : 0);
  for (auto _ : state) {
    field.evaluate(points_mm, values, gradients);
    benchmark::DoNotOptimize(values.data());
  }
  state.counters["centres"] = static_cast<double>(field.centre_count());
  state.counters["points_per_s"] =
      benchmark::Counter(static_cast<double>(kPoints), benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(evaluate_rbf)->ArgName("gradient")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond)->UseRealTime();

void fit_rbf(benchmark::State& state) {
  surface();
  for (auto _ : state) {
    const SurfaceFit fit = fit_surface(surface());
    state.counters["centres"] = static_cast<double>(fit.field.centre_count());
  }
}
BENCHMARK(fit_rbf)->Iterations(1)->Unit(benchmark::kSecond)->UseRealTime();

void bake_rbf(benchmark::State& state) {
  const CtVolume ct = even_ct();
  const RbfField& field = rbf();
  BakeReport report;
  for (auto _ : state) bake_bone(field, surface().positions_mm, ct, {}, {}, &report);
  state.counters["voxels"] = static_cast<double>(report.evaluations);
}
BENCHMARK(bake_rbf)->Iterations(1)->Unit(benchmark::kSecond)->UseRealTime();

void fill_standard_volume(benchmark::State& state) {
  const Vertebra vertebra;
  const PedicleGroundTruth pedicle = vertebra_ground_truth(vertebra).left;
  const Vec3 along = (pedicle.target_mm - pedicle.entry_mm).normalized();
  PointVolume volume({"left", pedicle.entry_mm, pedicle.entry_mm + 37.8 * along, {}}, {});
  const BoneModel& model = bone();
  for (auto _ : state) {
    fill_volume(volume, [&](std::span<const Vec3> points_mm, std::span<float> distance_mm, std::span<float> hu) {
      model.sample(points_mm, distance_mm, hu);
    });
  }
  state.counters["points"] = static_cast<double>(volume.point_count());
  state.counters["in_bone"] = static_cast<double>(volume.occupied_count());
  state.counters["points_per_s"] =
      benchmark::Counter(static_cast<double>(volume.point_count()), benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(fill_standard_volume)->Unit(benchmark::kMillisecond)->UseRealTime();

void mesh_bone(benchmark::State& state) {
  const BoneModel& model = bone();
  for (auto _ : state) {
    const TriangleMesh mesh = bone_surface(model);
    state.counters["triangles"] = static_cast<double>(mesh.triangles.size());
  }
}
BENCHMARK(mesh_bone)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace spinaltap

BENCHMARK_MAIN();
