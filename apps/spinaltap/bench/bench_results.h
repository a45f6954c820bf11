#pragma once

#include <string>
#include <vector>

#include "apps/spinaltap/bench/drill_workload.h"
#include "apps/spinaltap/bench/measure_engine.h"
#include "apps/spinaltap/bench/milling_workload.h"
#include "core/files/json_file.h"

namespace spinaltap {

/// An engine that `spinaltap bench drill` can measure.
struct BenchEngine {
  std::string name;
  EngineFactory make;            ///< for points; none: it is of voxels, and only mills
  bool runs_whole_path = false;  ///< else it is so slow that windows of the path must do
  bool uses_threads = false;     ///< else it is measured once, whatever --threads says
  bool mills = false;            ///< goes where it likes in the whole bone, or in a wide cylinder
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

/// One engine on one milling.
struct BenchMillingResult {
  std::string engine;
  MillingWorkload workload;
  std::size_t points = 0;  ///< or voxels, of bone
  EngineMeasurement measured;
};

struct BenchResults {
  std::vector<BenchResult> runs;
  std::vector<BenchStepResult> steps;
  std::vector<BenchMillingResult> millings;
};

/// What the engine `auto` comes to on a workload, against the engines that were measured on it.
struct AutoChoice {
  std::string workload;
  double spacing_mm = 0.1;
  std::string engine = {};  ///< that auto takes
  std::string best = {};    ///< of those that were measured
  double to_best = 1.0;     ///< CPU time of the first over the other's: of all of a path, or the median of a step
};
/// Of each workload on which auto's engine was measured beside another, with the first number of threads.
std::vector<AutoChoice> auto_choices(const BenchResults& results);

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
