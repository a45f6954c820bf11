// Surfaces to show and to print: the phantom of an L3 vertebra, voxels of 0.25 mm, meshed anew from its isosurface.

#include <benchmark/benchmark.h>

#include "core/phantom/vertebra.h"
#include "mesh/display_mesh.h"
#include "mesh/self_intersections.h"
#include "vdb/bake/bake.h"
#include "vdb/grid/isosurface.h"

namespace spinaltap {
namespace {

const BoneModel& bone() {
  static const BoneModel model = bake_solid(Vertebra(), {}, 40.0);
  return model;
}

/// The argument is the largest error, um.
void mesh_phantom(benchmark::State& state) {
  const BoneModel& model = bone();
  RemeshReport report;
  for (auto _ : state) {
    const TriangleMesh mesh =
        display_mesh(model, {.max_error_mm = 1e-3 * static_cast<double>(state.range(0))}, &report);
    state.counters["triangles"] = static_cast<double>(mesh.triangles.size());
  }
  state.counters["smallest_angle_deg"] = report.smallest_angle_deg;
  state.counters["mesh_to_surface_um"] = 1e3 * report.to_surface.max_mm;
  state.counters["surface_to_mesh_um"] = 1e3 * report.from_surface.max_mm;
}
BENCHMARK(mesh_phantom)
    ->ArgName("error_um")
    ->Arg(20)
    ->Arg(50)
    ->Arg(200)
    ->Iterations(1)
    ->Unit(benchmark::kSecond)
    ->MeasureProcessCPUTime();

void find_self_intersections(benchmark::State& state) {
  const TriangleMesh mesh = bone_surface(bone());
  for (auto _ : state) benchmark::DoNotOptimize(self_intersections(mesh).size());
  state.counters["triangles"] = static_cast<double>(mesh.triangles.size());
}
BENCHMARK(find_self_intersections)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

}  // namespace
}  // namespace spinaltap

BENCHMARK_MAIN();
