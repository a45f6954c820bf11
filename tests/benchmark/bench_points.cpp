// From the files of a CT (95 slices of 512 x 512, 0.352 x 0.352 x 0.5 mm) to its surface points: how long each stage
// takes, and how well the three methods lie on the ground truth: the phantom of an L3 vertebra and, where
// SPINALTAP_TEST_DATA names the folder of the real CTs, the mesh of a real one.

#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include <memory>

#include "core/ct/dicom_write.h"
#include "core/ct/read_ct.h"
#include "core/phantom/scanner.h"
#include "core/phantom/vertebra.h"
#include "core/segment/segment_spine.h"
#include "core/surface/surface_samples.h"
#include "tests/support/mesh_of_real_vertebra.h"
#include "tests/support/point_error.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_data.h"
#include "vdb/grid/mesh_solid.h"

namespace spinaltap {
namespace {

struct Scanned {
  std::unique_ptr<Solid> solid;
  CtVolume ct;
  BoneMask mask;
};

Scanned scan_of(std::unique_ptr<Solid> solid) {
  ScanOptions options;
  const double height_mm = solid->bounds_mm().sizes().z() + 6.0;
  options.slices = std::max(options.slices, static_cast<int>(height_mm / options.slice_step_mm));
  Scanned scanned{std::move(solid), {}, {}};
  scanned.ct = scan(*scanned.solid, options);
  scanned.mask = segment_vertebra(scanned.ct).mask;
  return scanned;
}

const Scanned& phantom() {
  static const Scanned scanned = scan_of(std::make_unique<Vertebra>());
  return scanned;
}

const Scanned& real_mesh() {
  static const Scanned scanned =
      scan_of(make_mesh_solid(test::read_real_vertebra(test::test_data_folder() / "L3_mesh")));
  return scanned;
}

double peak_memory_mib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

/// First, so that the peak of memory is its own.
void from_files_to_points(benchmark::State& state) {
  const test::TemporaryFolder folder;
  {
    ScanOptions options;
    options.slices = 95;
    std::filesystem::create_directory(folder.path() / "ct");
    write_dicom(scan(Vertebra(), options), folder.path() / "ct");
  }
  const double before_mib = peak_memory_mib();
  for (auto _ : state) {
    const CtVolume ct = read_ct(folder.path() / "ct");
    const BoneMask mask = segment_vertebra(ct).mask;
    const SurfaceSamples samples = sample_surface(ct, mask);
    state.counters["points"] = static_cast<double>(samples.positions_mm.size());
  }
  state.counters["peak_MiB"] = peak_memory_mib();
  state.counters["peak_MiB_of_the_scanner_before"] = before_mib;
}
BENCHMARK(from_files_to_points)->Iterations(1)->Repetitions(5)->Unit(benchmark::kSecond)->UseRealTime();

void points_of(benchmark::State& state, const Scanned& scanned, PointMethod method) {
  SurfaceSamples samples;
  for (auto _ : state) samples = sample_surface(scanned.ct, scanned.mask, {.method = method});
  const test::PointError error = test::point_error(std::span(samples.positions_mm).first(samples.surface_count),
                                                   *scanned.solid, scanned.ct.geometry.spacing_mm.z());
  state.counters["surface"] = static_cast<double>(samples.surface_count);
  state.counters["all"] = static_cast<double>(samples.positions_mm.size());
  state.counters["dropped"] = static_cast<double>(samples.dropped);
  state.counters["mean_mm"] = error.mean_mm;
  state.counters["p99_mm"] = error.p99_mm;
  state.counters["inter_slice_jitter_mm"] = error.inter_slice_jitter_mm;
}

}  // namespace
}  // namespace spinaltap

int main(int argc, char** argv) {
  using spinaltap::PointMethod;
  const auto add = [](const char* body, const spinaltap::Scanned& (*scanned)()) {
    for (const auto& [name, method] : {std::pair{"pixels", PointMethod::pixels},
                                       {"normals", PointMethod::normals},
                                       {"contours", PointMethod::contours}}) {
      benchmark::RegisterBenchmark(
          (std::string(body) + "/" + name).c_str(),
          [scanned, method = method](benchmark::State& state) { spinaltap::points_of(state, scanned(), method); })
          ->Unit(benchmark::kSecond)
          ->UseRealTime();
    }
  };
  add("phantom", spinaltap::phantom);
  if (!spinaltap::test::test_data_folder().empty()) add("real_mesh", spinaltap::real_mesh);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
