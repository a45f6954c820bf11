// Radial basis functions: fitting, choosing few centres, evaluating. fit_vertebra needs nothing; the others run on the
// points that other libraries were measured on, $SPINALTAP_TEST_DATA/rbf_points, and are left out without them.
// peak_MB is the largest resident memory of the whole program while the case ran.

#include <benchmark/benchmark.h>
#include <malloc.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <string>

#include "core/base/random.h"
#include "core/rbf/detail/fast_sum.h"
#include "core/rbf/fit_rbf.h"
#include "core/rbf/rbf_field.h"
#include "core/rbf/value_file.h"
#include "tests/support/test_data.h"
#include "tests/support/vertebra_values.h"

namespace spinaltap {
namespace {

void reset_peak() {
  malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5";
}

double peak_mb() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    double kib = 0.0;
    if (word == "VmHWM:" && status >> kib) return kib / 1024.0;
  }
  return 0.0;
}

/// The points of a file, read once; none where there is no such file.
const RbfValues& peer_values(const std::string& name) {
  static std::map<std::string, RbfValues> known;
  const auto [entry, is_new] = known.try_emplace(name);
  const std::filesystem::path path = test::test_data_folder() / "rbf_points" / (name + ".csv.gz");
  if (is_new && std::filesystem::exists(path)) entry->second = read_values(path);
  return entry->second;
}

void measure_fit(benchmark::State& state, const RbfValues& data, const FitOptions& options) {
  FitReport report;
  reset_peak();
  for (auto _ : state) report = fit_rbf(data, options).report;
  state.counters["values"] = static_cast<double>(report.points);
  state.counters["centres"] = static_cast<double>(report.centres);
  state.counters["iterations"] = report.iterations;
  state.counters["max_residual_mm"] = report.max_residual_mm;
  state.counters["peak_MB"] = peak_mb();
}

void fit_vertebra(benchmark::State& state) {
  measure_fit(state, test::vertebra_values(static_cast<std::size_t>(state.range(0))), {.accuracy_mm = 0.01});
}
BENCHMARK(fit_vertebra)
    ->ArgName("values")
    ->Arg(11'000)
    ->Arg(22'000)
    ->Arg(44'000)
    ->Arg(88'000)
    ->Arg(132'000)
    ->Arg(500'000)
    ->Iterations(1)
    ->Repetitions(3)
    ->Unit(benchmark::kSecond)
    ->UseRealTime();

void fit_peer(benchmark::State& state, const char* name, FitOptions options) {
  if (peer_values(name).points_mm.empty()) return state.SkipWithError("set SPINALTAP_TEST_DATA");
  measure_fit(state, peer_values(name), options);
}
#define FIT_PEER(label, name, ...)                                  \
  BENCHMARK_CAPTURE(fit_peer, label, name, FitOptions{__VA_ARGS__}) \
      ->Iterations(1)                                               \
      ->Repetitions(3)                                              \
      ->Unit(benchmark::kSecond)                                    \
      ->UseRealTime()
FIT_PEER(87k_to_0.1, "one_off", .accuracy_mm = 0.1);
FIT_PEER(87k_to_0.01, "one_off", .accuracy_mm = 0.01);
FIT_PEER(132k_to_0.1, "two_off", .accuracy_mm = 0.1);
FIT_PEER(132k_to_0.01, "two_off", .accuracy_mm = 0.01);
FIT_PEER(87k_smooth_points_triharmonic, "one_offsmooth", .kernel = RadialKernel::triharmonic, .accuracy_mm = 0.01);
FIT_PEER(87k_reduced_to_0.1, "one_off", .reduction_mm = 0.1);
FIT_PEER(87k_smooth_points_reduced_to_0.1, "one_offsmooth", .reduction_mm = 0.1);
FIT_PEER(87k_reduced_in_5_slabs, "one_off", .reduction_mm = 0.1, .slabs = 5);
FIT_PEER(87k_smoothed_by_0.2_reduced_to_0.1, "one_off", .smoothing_mm = 0.2, .reduction_mm = 0.1);
FIT_PEER(87k_smoothed_by_0.5_reduced_to_0.1, "one_off", .smoothing_mm = 0.5, .reduction_mm = 0.1);
FIT_PEER(87k_smoothed_by_30, "one_off", .smoothing_mm = 30.0);

void fit_error_bars(benchmark::State& state) {
  RbfValues data = peer_values("one_off");
  if (data.points_mm.empty()) return state.SkipWithError("set SPINALTAP_TEST_DATA");
  data.error_bars_mm.assign(data.points_mm.size(), 0.3);
  measure_fit(state, data, {});
}
BENCHMARK(fit_error_bars)->Iterations(1)->Repetitions(3)->Unit(benchmark::kSecond)->UseRealTime();

const RbfModel& peer_model() {
  static const RbfModel model = fit_rbf(peer_values("one_off")).model;
  return model;
}

/// Places within 0.5 mm of centres along each axis.
std::vector<Vec3> places_near(const std::vector<Vec3>& centres_mm, std::size_t count) {
  constexpr std::uint64_t kSeed = 10;
  std::vector<Vec3> places_mm(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto shift = [&](std::uint64_t axis) { return random_uniform(kSeed + axis, i) - 0.5; };
    places_mm[i] = centres_mm[mix_bits(i) % centres_mm.size()] + Vec3(shift(0), shift(1), shift(2));
  }
  return places_mm;
}

void prepare_field(benchmark::State& state) {
  if (peer_values("one_off").points_mm.empty()) return state.SkipWithError("set SPINALTAP_TEST_DATA");
  peer_model();
  for (auto _ : state) benchmark::DoNotOptimize(RbfField(peer_model()).value_error_mm());
}
BENCHMARK(prepare_field)->Iterations(1)->Repetitions(3)->Unit(benchmark::kSecond)->UseRealTime();

/// Value and gradient within 1e-3, 87,706 centres.
void evaluate_near(benchmark::State& state) {
  if (peer_values("one_off").points_mm.empty()) return state.SkipWithError("set SPINALTAP_TEST_DATA");
  const RbfField field(peer_model());
  const std::vector<Vec3> places_mm = places_near(peer_model().centres_mm, static_cast<std::size_t>(state.range(0)));
  std::vector<double> values_mm(places_mm.size());
  std::vector<Vec3> gradients(places_mm.size());
  reset_peak();
  for (auto _ : state) field.evaluate(places_mm, values_mm, gradients);
  state.counters["peak_MB"] = peak_mb();
  const double arrays = static_cast<double>(places_mm.size()) * (2 * sizeof(Vec3) + sizeof(double));
  state.counters["arrays_MB"] = arrays / 1048576.0;
  state.counters["value_error_mm"] = field.value_error_mm();
  state.counters["gradient_error"] = field.gradient_error();
}
BENCHMARK(evaluate_near)
    ->Arg(1'000'000)
    ->Arg(10'000'000)
    ->Iterations(1)
    ->Repetitions(3)
    ->Unit(benchmark::kSecond)
    ->UseRealTime();

/// The same count of values anywhere in the centres' box; and with their gradients.
void evaluate_anywhere(benchmark::State& state, bool wants_gradients) {
  if (peer_values("one_off").points_mm.empty()) return state.SkipWithError("set SPINALTAP_TEST_DATA");
  const RbfField field(peer_model());
  const Box3 box = bounds_of(peer_model().centres_mm);
  constexpr std::uint64_t kSeed = 30;
  std::vector<Vec3> places_mm(static_cast<std::size_t>(state.range(0)));
  for (std::size_t i = 0; i < places_mm.size(); ++i) {
    const Vec3 part(random_uniform(kSeed, i), random_uniform(kSeed + 1, i), random_uniform(kSeed + 2, i));
    places_mm[i] = box.min() + box.sizes().cwiseProduct(part);
  }
  std::vector<double> values_mm(places_mm.size());
  std::vector<Vec3> gradients(wants_gradients ? places_mm.size() : 0);
  reset_peak();
  for (auto _ : state) field.evaluate(places_mm, values_mm, gradients);
  state.counters["peak_MB"] = peak_mb();
  state.counters["value_error_mm"] = field.value_error_mm();
}
BENCHMARK_CAPTURE(evaluate_anywhere, values, false)
    ->Arg(1'000'000)
    ->Iterations(1)
    ->Repetitions(3)
    ->Unit(benchmark::kSecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(evaluate_anywhere, gradients, true)
    ->Arg(1'000'000)
    ->Iterations(1)
    ->Repetitions(3)
    ->Unit(benchmark::kSecond)
    ->UseRealTime();

/// As many values on a lattice over the centres' box.
void evaluate_lattice(benchmark::State& state) {
  if (peer_values("one_off").points_mm.empty()) return state.SkipWithError("set SPINALTAP_TEST_DATA");
  const RbfField field(peer_model());
  const Box3 box = bounds_of(peer_model().centres_mm);
  const double step_mm = std::cbrt(box.volume() / static_cast<double>(state.range(0)));
  std::vector<Vec3> places_mm;
  for (double z = box.min().z(); z <= box.max().z(); z += step_mm) {
    for (double y = box.min().y(); y <= box.max().y(); y += step_mm) {
      for (double x = box.min().x(); x <= box.max().x(); x += step_mm) places_mm.emplace_back(x, y, z);
    }
  }
  std::vector<double> values_mm(places_mm.size());
  reset_peak();
  for (auto _ : state) field.evaluate(places_mm, values_mm, {});
  state.counters["values"] = static_cast<double>(values_mm.size());
  state.counters["peak_MB"] = peak_mb();
}
BENCHMARK(evaluate_lattice)
    ->Arg(1'000'000)
    ->Arg(10'000'000)
    ->Iterations(1)
    ->Repetitions(3)
    ->Unit(benchmark::kSecond)
    ->UseRealTime();

/// Sums term by term, one thread: pairs of a place and a centre a second.
void direct_pairs(benchmark::State& state, bool gradient) {
  const detail::SimdKernels& simd = detail::simd_kernels()[static_cast<std::size_t>(state.range(0))];
  constexpr std::size_t kSources = 2048;
  std::vector<double> numbers(4 * kSources);
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = random_uniform(1, i);
  std::vector<double> targets(3 * detail::kLanes, 0.3);
  detail::LaneSums sums{};
  for (auto _ : state) {
    simd.near_sum(
        1, gradient, targets.data(),
        {numbers.data(), numbers.data() + kSources, numbers.data() + 2 * kSources, numbers.data() + 3 * kSources}, 0,
        kSources, 0.0, sums);
    benchmark::DoNotOptimize(sums);
  }
  state.SetLabel(simd.name);
  state.counters["pairs_per_s"] =
      benchmark::Counter(static_cast<double>(kSources * detail::kLanes), benchmark::Counter::kIsIterationInvariantRate);
}
void every_instruction_set(benchmark::internal::Benchmark* bench) {
  for (std::size_t k = 0; k < detail::simd_kernels().size(); ++k) bench->Arg(static_cast<std::int64_t>(k));
}
BENCHMARK_CAPTURE(direct_pairs, values, false)->Apply(every_instruction_set);
BENCHMARK_CAPTURE(direct_pairs, gradients, true)->Apply(every_instruction_set);

}  // namespace
}  // namespace spinaltap

BENCHMARK_MAIN();
