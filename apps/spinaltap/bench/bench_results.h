#pragma once

#include <string>
#include <vector>

#include "apps/spinaltap/bench/drill_workload.h"
#include "apps/spinaltap/bench/measure_engine.h"
#include "core/files/json_file.h"

namespace spinaltap {

/// An engine that `spinaltap bench drill` can measure.
struct BenchEngine {
  std::string name;
  EngineFactory make;
  bool runs_whole_path = false;  ///< else it is so slow that windows of the path must do
  bool uses_threads = false;     ///< else it is measured once, whatever --threads says
};

/// All there are, the paper's first: the others are compared with it.
const std::vector<BenchEngine>& bench_engines();

/// One engine on one workload.
struct BenchResult {
  std::string engine;
  WorkloadMotion motion = WorkloadMotion::on_path;
  double diameter_mm = 3.0;
  double spacing_mm = 0.1;
  int threads = 1;
  std::size_t points = 0;
  EngineMeasurement measured;
};

/// One long step of one engine, several times.
struct BenchStepResult {
  std::string engine;
  std::string step;
  double spacing_mm = 0.025;
  int threads = 1;
  std::vector<StepMeasurement> repeats;

  double median_wall_ms() const;
  double min_wall_ms() const;
  double median_cpu_ms() const;  ///< of all threads
};

struct BenchResults {
  std::vector<BenchResult> runs;
  std::vector<BenchStepResult> steps;
};

/// The reference engine on the same workload; null where it was not measured.
const BenchResult* reference_of(const BenchResults& results, const BenchResult& result);

/// Tables for people. `markdown` for a page, else for a terminal.
std::string bench_tables(const BenchResults& results, bool markdown);

/// The same figures, and the curves.
Json to_json(const BenchResults& results);

/// The paper's figures 20 and 21 drawn anew, as an HTML page: cycles a second along the path. Of the runs with the
/// first bit and number of threads that there are.
std::string bench_page(const BenchResults& results, const std::string& machine);

}  // namespace spinaltap
