#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <optional>
#include <thread>

#include "apps/spinaltap/bench/bench_results.h"
#include "apps/spinaltap/command.h"
#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "core/base/text_writer.h"
#include "core/base/version.h"

namespace spinaltap {
namespace {

struct BenchOptions {
  std::vector<std::string> engines;
  std::vector<std::string> motions;
  std::vector<double> diameters_mm;  ///< empty: 3.0 and 3.06, of millings 3, 4 and 6
  std::vector<double> spacings_mm;   ///< empty: 0.1, and 0.025 for long steps, 0.1 and 0.2 for millings
  std::vector<int> threads{1, 2};
  int hu_bits = 8;
  std::size_t window = 200;
  std::uint64_t seed = 1;
  bool is_markdown = false;
  std::filesystem::path json_file;
  std::filesystem::path plot_file;
};

const std::vector<StepWorkload>& step_workloads() {
  static const std::vector<StepWorkload> steps{burr_step(), sideways_step()};
  return steps;
}

constexpr const char* kMilling = "milling";

/// "burr" of "burr 1 mm", as --motion has it.
std::string first_word(std::string_view name) { return std::string(name.substr(0, name.find(' '))); }

std::vector<std::string> all_engines() {
  std::vector<std::string> names;
  for (const BenchEngine& engine : bench_engines()) names.push_back(engine.name);
  return names;
}

std::vector<std::string> all_motions() {
  std::vector<std::string> names;
  for (const WorkloadMotion motion : workload_motions()) names.emplace_back(name_of(motion));
  for (const StepWorkload& step : step_workloads()) names.push_back(first_word(step.name));
  names.emplace_back(kMilling);
  return names;
}

bool has(const std::vector<std::string>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// "Intel(R) Xeon(R) Processor, 2 cores, load 1.2".
std::string machine() {
  std::string model = "unknown processor";
  std::ifstream cpus("/proc/cpuinfo");
  for (std::string line; std::getline(cpus, line);) {
    if (!line.starts_with("model name")) continue;
    const std::size_t colon = line.find(": ");
    if (colon != std::string::npos) model = line.substr(colon + 2);
    break;
  }
  std::string load = "unknown";
  std::ifstream("/proc/loadavg") >> load;
  return model + ", " + std::to_string(std::thread::hardware_concurrency()) + " cores, load before the run " + load;
}

class Bench {
 public:
  Bench(const BenchOptions& options, const Progress& progress) : options_(options), progress_(progress) {}

  BenchResults run() {
    const auto spacings = [&](const std::vector<double>& without) {
      return options_.spacings_mm.empty() ? without : options_.spacings_mm;
    };
    for (const double spacing_mm : spacings({0.1})) {
      for (const WorkloadMotion motion : workload_motions()) {
        if (has(options_.motions, name_of(motion))) run_motion(spacing_mm, motion);
      }
    }
    for (const double spacing_mm : spacings({0.025})) {
      for (const StepWorkload& step : step_workloads()) {
        if (has(options_.motions, first_word(step.name))) run_step(spacing_mm, step);
      }
    }
    volume_.reset();
    if (!has(options_.motions, kMilling)) return std::move(results_);
    progress_.report("baking the phantom", 0.0);
    const BoneModel bone = milling_bone();
    for (const double spacing_mm : spacings({0.1, 0.2})) run_millings(bone, spacing_mm);
    return std::move(results_);
  }

 private:
  PointVolume& volume_of(double spacing_mm) {
    if (!volume_ || volume_->pattern().spacing_mm() != spacing_mm) {
      volume_.reset();
      progress_.report("making points", 0.0);
      volume_.emplace(workload_volume(spacing_mm, options_.hu_bits == 8 ? HuBits::eight : HuBits::sixteen));
    }
    return *volume_;
  }

  std::vector<double> diameters(const std::vector<double>& without) const {
    return options_.diameters_mm.empty() ? without : options_.diameters_mm;
  }

  void run_motion(double spacing_mm, WorkloadMotion motion) {
    PointVolume& volume = volume_of(spacing_mm);
    const std::vector<Pose> poses = workload_poses(motion, options_.seed);
    for (const double diameter_mm : diameters({3.0, 3.06})) {
      const std::size_t first = results_.runs.size();
      for (const BenchEngine& engine : bench_engines()) {
        if (!engine.make || !has(options_.engines, engine.name)) continue;
        if (!engine.runs_whole_path && !is_of_paper(motion)) continue;
        const EngineRun run{engine.make, workload_bit(motion, diameter_mm), poses};
        for (const int threads : options_.threads) {
          const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                          static_cast<std::size_t>(threads));
          TextWriter stage;
          stage << engine.name << ", " << name_of(motion) << ", " << diameter_mm << " mm";
          BenchResult result{engine.name,          motion, diameter_mm, spacing_mm, engine.uses_threads ? threads : 1,
                             volume.point_count(), {}};
          const WindowOptions windows{.cycles = options_.window, .finer_curve = !options_.plot_file.empty()};
          result.measured = engine.runs_whole_path
                                ? measure_whole_path(run, volume, costs_, progress_, stage.str())
                                : measure_windows(run, volume, costs_, windows, progress_, stage.str());
          check_same_points(result, first);
          results_.runs.push_back(std::move(result));
          if (!engine.uses_threads) break;
        }
      }
    }
  }

  /// Whole paths of one workload, from results_.runs[first] on, must leave the same points occupied.
  void check_same_points(const BenchResult& result, std::size_t first) const {
    if (!result.measured.is_whole_path) return;
    for (std::size_t n = first; n < results_.runs.size(); ++n) {
      const BenchResult& other = results_.runs[n];
      if (!other.measured.is_whole_path || other.measured.occupancy_hash == result.measured.occupancy_hash) continue;
      fail("bench: expected the same points occupied after ", name_of(result.motion), " with a bit of ",
           result.diameter_mm, " mm, found that ", result.engine, " (", result.threads, " threads) and ", other.engine,
           " (", other.threads, " threads) differ");
    }
  }

  /// Numbers of threads take turns, so that what else the machine does falls on all of them.
  void run_step(double spacing_mm, const StepWorkload& step) {
    constexpr std::size_t kRepeats = 5;
    PointVolume& volume = volume_of(spacing_mm);
    const std::array<Pose, 2> poses{step.from, step.to};
    const std::size_t first = results_.steps.size();
    for (const BenchEngine& engine : bench_engines()) {
      // The others take seconds a step and never share it out.
      if (!engine.make || !engine.uses_threads || !has(options_.engines, engine.name)) continue;
      const std::size_t own = results_.steps.size();
      for (const int threads : options_.threads) {
        results_.steps.push_back({engine.name, std::string(step.name), spacing_mm, threads, {}});
      }
      const std::string stage = engine.name + ", " + std::string(step.name);
      ProgressCounter counter(progress_, stage, kRepeats * options_.threads.size());
      for (std::size_t repeat = 0; repeat < kRepeats; ++repeat) {
        for (std::size_t n = own; n < results_.steps.size(); ++n) {
          BenchStepResult& result = results_.steps[n];
          const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                          static_cast<std::size_t>(result.threads));
          result.repeats.push_back(measure_step({engine.make, step.bit, poses}, volume));
          if (result.repeats.back().occupancy_hash != results_.steps[first].repeats.front().occupancy_hash) {
            fail("bench: expected the same points occupied after ", step.name, ", found that ", engine.name, " with ",
                 result.threads, " threads differs");
          }
          counter.add();
        }
      }
    }
  }

  /// What is milled at a spacing: each burr at each tilt; the 4 mm one in short steps and with forces too, and turned
  /// about a place 50 mm behind its tip.
  std::vector<MillingWorkload> millings(double spacing_mm) const {
    std::vector<MillingWorkload> workloads;
    for (const double diameter_mm : diameters({3.0, 4.0, 6.0})) {
      for (const double tilt_deg : {0.0, 30.0, 80.0}) {
        workloads.push_back({.diameter_mm = diameter_mm, .tilt_deg = tilt_deg, .spacing_mm = spacing_mm});
      }
      if (diameter_mm != 4.0) continue;
      workloads.push_back({.step_mm = 0.01, .spacing_mm = spacing_mm});
      for (const double tilt_deg : {0.0, 30.0, 80.0}) {
        workloads.push_back({.tilt_deg = tilt_deg, .spacing_mm = spacing_mm, .has_forces = true});
      }
      constexpr double kLeverMm = 50.0;
      workloads.push_back({.step_mm = kLeverMm * kDegree, .spacing_mm = spacing_mm, .lever_mm = kLeverMm});
    }
    return workloads;
  }

  /// On one thread, whatever --threads says.
  void run_millings(const BoneModel& model, double spacing_mm) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
    const std::size_t first = results_.millings.size();
    for (const BenchEngine& engine : bench_engines()) {
      if (!engine.mills || !has(options_.engines, engine.name)) continue;
      const bool has_points = engine.make != nullptr;
      const DrilledBone whole = milled_bone(model, has_points ? EngineKind::leaf : EngineKind::voxel, spacing_mm);
      DrilledBone bone(whole);
      for (const MillingWorkload& workload : millings(spacing_mm)) {
        if (has_points && (workload.tilt_deg > kMaxPointTiltDeg || workload.has_forces || workload.lever_mm > 0.0)) {
          continue;
        }
        const std::vector<Pose> poses = milling_poses(workload, kMillingCycles, options_.seed);
        TextWriter stage;
        stage << engine.name << ", milling, " << workload.diameter_mm << " mm, " << workload.tilt_deg << " degrees";
        results_.millings.push_back(
            {engine.name, workload, whole.occupied_count(),
             measure_way(milling_run(bone, whole, workload, poses), costs_, progress_, stage.str())});
        check_same_hole(first);
      }
    }
  }

  /// Points lie elsewhere than voxels, but the last milling must have taken as much bone as the same one before it.
  void check_same_hole(std::size_t first) const {
    const double share = std::max(0.01, 0.05 * results_.millings.back().workload.spacing_mm);  // of coarse points
    const BenchMillingResult& last = results_.millings.back();
    for (std::size_t n = first; n + 1 < results_.millings.size(); ++n) {
      const BenchMillingResult& other = results_.millings[n];
      const bool is_same = other.workload.diameter_mm == last.workload.diameter_mm &&
                           other.workload.tilt_deg == last.workload.tilt_deg &&
                           other.workload.step_mm == last.workload.step_mm;
      const double mm3 = last.measured.all.removed_mm3, other_mm3 = other.measured.all.removed_mm3;
      if (!is_same || std::abs(mm3 - other_mm3) <= share * other_mm3) continue;
      fail("bench: expected the same volume milled by a burr of ", last.workload.diameter_mm, " mm at ",
           last.workload.tilt_deg, " degrees, found ", mm3, " mm³ by ", last.engine, " and ", other_mm3, " mm³ by ",
           other.engine);
    }
  }

  const BenchOptions& options_;
  const Progress& progress_;
  const ClockCosts costs_ = measure_clock_costs();
  std::optional<PointVolume> volume_;
  BenchResults results_;
};

Json run_bench(const BenchOptions& options, const Progress& progress) {
  // Files that cannot be written are rejected before the work.
  StagedOutput output;
  std::filesystem::path staged_json;
  std::filesystem::path staged_plot;
  if (!options.json_file.empty()) staged_json = output.stage(options.json_file);
  if (!options.plot_file.empty()) staged_plot = output.stage(options.plot_file);

  const std::string where = machine();
  const BenchResults results = Bench(options, progress).run();
  std::printf("%s; spinaltap %s; seed %llu\n\n%s", where.c_str(), version(),
              static_cast<unsigned long long>(options.seed), bench_tables(results, options.is_markdown).c_str());
  Json figures{{"machine", where},
               {"format", "spinaltap-benchmark"},
               {"version", kFormatVersion},
               {"program", version()},
               {"seed", options.seed},
               {"hu_bits", options.hu_bits},
               {"window_cycles", options.window}};
  figures.update(to_json(results));
  if (!staged_json.empty()) write_whole_file(staged_json, figures.dump(2) + "\n");
  if (!staged_plot.empty()) write_whole_file(staged_plot, bench_page(results, where));
  output.commit();
  return figures;
}

}  // namespace

void add_bench(CLI::App& program, Command& command) {
  const auto options = std::make_shared<BenchOptions>();
  options->engines = all_engines();
  options->motions = all_motions();
  CLI::App* bench = program.add_subcommand("bench", "Measure on this machine");
  bench->require_subcommand(1);
  CLI::App* app = add_command(
      *bench, command, "drill", "Measure the drilling engines on the paper's workload, and milling",
      "Example: spinaltap bench drill --motion tremor,on-path --diameter 3.06 --json bench.json --plot bench.html\n"
      "The cylinder has a radius of 3 mm and a length of 37.8 mm: 986,958 points at 0.1 mm, 64,775,592 at 0.025 mm\n"
      "(75 MB). Millings are of a whole virtual L3. Rates are cycles per second of CPU time; times are microseconds.\n"
      "`reference` and `arc` are slow: they are timed in windows of --window cycles, and on the paper's motions only.\n"
      "With the defaults it takes some minutes.");
  // This command has lists of threads, and writes its JSON together with the plot.
  app->remove_option(app->get_option("--threads"));
  app->remove_option(app->get_option("--json"));
  app->add_option("--json", options->json_file, "Write the figures to this file as JSON")->type_name("FILE");
  app->add_option("--plot", options->plot_file, "Write the paper's figures 20 and 21, drawn anew, to this HTML file")
      ->type_name("FILE");
  app->add_option("--engine", options->engines, "Engines to measure")
      ->delimiter(',')
      ->check(CLI::IsMember(all_engines()))
      ->capture_default_str()
      ->type_name("NAME,...");
  app->add_option("--motion", options->motions, "Motions along the path, long steps (burr, sideways), and milling")
      ->delimiter(',')
      ->check(CLI::IsMember(all_motions()))
      ->capture_default_str()
      ->type_name("NAME,...");
  app->add_option("--diameter", options->diameters_mm,
                  "Diameters of the bit, mm; default: 3.0 and 3.06, of millings 3, 4 and 6")
      ->delimiter(',')
      ->check(CLI::Range(0.1, 6.0))
      ->type_name("MM,...");
  app->add_option("--spacing", options->spacings_mm,
                  "Distances between points, mm; default: 0.1; 0.025 for long steps; 0.1 and 0.2 for millings")
      ->delimiter(',')
      ->check(CLI::Range(0.02, 1.0))
      ->type_name("MM,...");
  app->add_option("--threads", options->threads, "Numbers of threads, for engines that share out work")
      ->delimiter(',')
      ->check(CLI::Range(1, 1024))
      ->capture_default_str()
      ->type_name("N,...");
  app->add_option("--hu-bits", options->hu_bits, "Bits of a point's CT number: 8 or 16")
      ->check(CLI::IsMember({8, 16}))
      ->capture_default_str()
      ->type_name("N");
  app->add_option("--window", options->window, "Cycles of a window, for slow engines")
      ->check(CLI::Range(1, 1800))
      ->capture_default_str()
      ->type_name("N");
  app->add_option("--seed", options->seed, "Of the operator's tremor")->capture_default_str()->type_name("N");
  app->add_flag("--markdown", options->is_markdown, "Print the tables as Markdown");

  command.run = [options](const Progress& progress) { return run_bench(*options, progress); };
}

}  // namespace spinaltap
