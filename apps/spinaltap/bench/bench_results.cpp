#include "apps/spinaltap/bench/bench_results.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "apps/report/text.h"
#include "apps/report/text_table.h"
#include "core/base/text_writer.h"
#include "core/session/choose_engine.h"
#include "vdb/engine/make_engine.h"

namespace spinaltap {
namespace {

/// Three digits at least.
std::string rounded(double value) { return readable_number(value, value < 10.0 ? 2 : value < 100.0 ? 1 : 0); }

std::string workload(const BenchResult& result) {
  return joined(name_of(result.motion), ", ", fixed_text(result.diameter_mm, 2));
}

double per_cycle(std::size_t sum, const Stretch& stretch) {
  return static_cast<double>(sum) / static_cast<double>(stretch.end - stretch.begin);
}

double bytes_per_point(const BenchResult& result) {
  return static_cast<double>(result.measured.memory_bytes) / static_cast<double>(result.points);
}

double ratio(const Stretch& stretch, const Stretch& reference) {
  return stretch.cycles_per_cpu_s() / reference.cycles_per_cpu_s();
}

/// Engines whose names carry a star were timed in windows.
std::string starred(const BenchResult& result) { return result.engine + (result.measured.is_whole_path ? "" : "*"); }

TextTable rates_table(const BenchResults& results) {
  TextTable table({{"motion, bit", "mm", false},
                   {"spacing", "mm"},
                   {"engine", "", false},
                   {"threads", ""},
                   {"first tenth", "cycles/s"},
                   {"middle", "cycles/s"},
                   {"last tenth", "cycles/s"},
                   {"to reference", "last tenth"},
                   {"by wall time", "cycles/s, last"},
                   {"removed", "points/cycle"},
                   {"tested", "points/cycle"},
                   {"memory", "bytes/point"}});
  for (const BenchResult& result : results.runs) {
    const EngineMeasurement& measured = result.measured;
    const BenchResult* reference = reference_of(results, result);
    table.add_row(
        {workload(result), short_text(result.spacing_mm), starred(result), std::to_string(result.threads),
         readable_number(measured.first_tenth.cycles_per_cpu_s(), 0),
         readable_number(measured.middle_tenth.cycles_per_cpu_s(), 0),
         readable_number(measured.last_tenth.cycles_per_cpu_s(), 0),
         reference == nullptr ? "" : rounded(ratio(measured.last_tenth, reference->measured.last_tenth)) + "x",
         readable_number(measured.last_tenth.cycles_per_wall_s(), 0),
         readable_number(per_cycle(measured.all.removed, measured.all), 2),
         rounded(per_cycle(measured.all.tested, measured.all)), readable_number(bytes_per_point(result), 3)});
  }
  return table;
}

TextTable times_table(const BenchResults& results) {
  TextTable table({{"motion, bit", "mm", false},
                   {"spacing", "mm"},
                   {"engine", "", false},
                   {"threads", ""},
                   {"cycles", ""},
                   {"CPU p50", "µs"},
                   {"p99", "µs"},
                   {"p99.9", "µs"},
                   {"max", "µs"},
                   {"wall p50", "µs"},
                   {"p99", "µs"},
                   {"p99.9", "µs"},
                   {"max", "µs"}});
  for (const BenchResult& result : results.runs) {
    const TimeSpread& cpu = result.measured.cpu;
    const TimeSpread& wall = result.measured.wall;
    table.add_row({workload(result), short_text(result.spacing_mm), starred(result), std::to_string(result.threads),
                   readable_number(static_cast<double>(result.measured.cycles), 0), rounded(cpu.p50_us),
                   rounded(cpu.p99_us), rounded(cpu.p999_us), rounded(cpu.max_us), rounded(wall.p50_us),
                   rounded(wall.p99_us), rounded(wall.p999_us), rounded(wall.max_us)});
  }
  return table;
}

/// The same step of the same engine with the first number of threads.
const BenchStepResult& first_of(const BenchResults& results, const BenchStepResult& result) {
  return *std::find_if(results.steps.begin(), results.steps.end(), [&](const BenchStepResult& other) {
    return other.engine == result.engine && other.step == result.step && other.spacing_mm == result.spacing_mm;
  });
}

double speed_up(const BenchResults& results, const BenchStepResult& result) {
  return first_of(results, result).median_wall_ms() / result.median_wall_ms();
}

TextTable steps_table(const BenchResults& results) {
  TextTable table({{"step", "", false},
                   {"spacing", "mm"},
                   {"engine", "", false},
                   {"threads", ""},
                   {"median", "ms, wall"},
                   {"min", "ms, wall"},
                   {"all threads", "ms, CPU"},
                   {"speed-up", ""},
                   {"removed", "points"},
                   {"tested", "points"}});
  for (const BenchStepResult& result : results.steps) {
    table.add_row({result.step, short_text(result.spacing_mm), result.engine, std::to_string(result.threads),
                   rounded(result.median_wall_ms()), rounded(result.min_wall_ms()), rounded(result.median_cpu_ms()),
                   readable_number(speed_up(results, result), 2) + "x",
                   readable_number(static_cast<double>(result.repeats[0].removed), 0),
                   readable_number(static_cast<double>(result.repeats[0].tested), 0)});
  }
  return table;
}

std::string milling_name(const BenchMillingResult& result) {
  return result.engine + (result.workload.has_forces       ? " with forces"
                          : result.workload.lever_mm > 0.0 ? ", turning"
                                                           : "");
}

TextTable millings_table(const BenchResults& results) {
  TextTable table({{"burr", "mm"},
                   {"tilt", "degrees"},
                   {"step", "µm"},
                   {"spacing", "mm"},
                   {"engine", "", false},
                   {"steps a second", "CPU"},
                   {"p50", "µs, CPU"},
                   {"p99", "µs"},
                   {"p99.9", "µs"},
                   {"wall p50", "µs"},
                   {"p99", "µs"},
                   {"p99.9", "µs"},
                   {"removed", "a step"},
                   {"tested", "a step"},
                   {"bone", "points"},
                   {"memory", "MB"}});
  for (const BenchMillingResult& result : results.millings) {
    const MillingWorkload& workload = result.workload;
    const EngineMeasurement& measured = result.measured;
    table.add_row(
        {short_text(workload.diameter_mm), short_text(workload.tilt_deg), short_text(1e3 * workload.step_mm),
         short_text(workload.spacing_mm), milling_name(result), readable_number(measured.all.cycles_per_cpu_s(), 0),
         rounded(measured.cpu.p50_us), rounded(measured.cpu.p99_us), rounded(measured.cpu.p999_us),
         rounded(measured.wall.p50_us), rounded(measured.wall.p99_us), rounded(measured.wall.p999_us),
         rounded(per_cycle(measured.all.removed, measured.all)), rounded(per_cycle(measured.all.tested, measured.all)),
         readable_number(static_cast<double>(result.points), 0),
         rounded(1e-6 * static_cast<double>(measured.memory_bytes))});
  }
  return table;
}

/// What others reach, as it was measured or published: not part of the run.
struct PeerMilling {
  const char* system;
  const char* cycles_a_second;
  const char* times_ms;  ///< p50 / p99 of a cycle
  const char* what;
};
constexpr std::array kPeers{PeerMilling{"CHAI3D voxel object, removing all contacted voxels, 10 µm a cycle", "900",
                                        "1.06 / 2.6", "scans a 33³ cube of voxels per pass"},
                            PeerMilling{"the same, 1 µm a cycle", "1,600", "0.57 / 1.5", ""},
                            PeerMilling{"CHAI3D example 28", "1,000-1,150", "0.8 / 1.9", "removes one voxel a cycle"},
                            PeerMilling{"LCSR volumetric_drilling (AMBF), 4 mm burr", "2,100", "0.61 / 1.4",
                                        "advances 0.2 µm a cycle whatever the hand does; force has no density in it"}};

TextTable peers_table() {
  TextTable table({{"system", "", false}, {"cycles a second", ""}, {"p50 / p99", "ms"}, {"what it does", "", false}});
  for (const PeerMilling& peer : kPeers) {
    table.add_row({peer.system, peer.cycles_a_second, peer.times_ms, peer.what});
  }
  return table;
}

TextTable auto_table(const std::vector<AutoChoice>& choices) {
  TextTable table({{"workload", "", false},
                   {"spacing", "mm"},
                   {"auto", "", false},
                   {"best", "", false},
                   {"time to the best's", ""}});
  for (const AutoChoice& choice : choices) {
    table.add_row({choice.workload, short_text(choice.spacing_mm), choice.engine, choice.best,
                   readable_number(choice.to_best, 2) + "x"});
  }
  return table;
}

/// By a member of each repeat, in ns, sorted.
std::vector<double> sorted_ms(const std::vector<StepMeasurement>& repeats, std::int64_t StepMeasurement::*member) {
  std::vector<double> values;
  values.reserve(repeats.size());
  for (const StepMeasurement& repeat : repeats) values.push_back(1e-6 * static_cast<double>(repeat.*member));
  std::sort(values.begin(), values.end());
  return values;
}

std::string hex(std::uint64_t value) {
  char text[32];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(value));
  return text;
}

Json quantiles_of(const TimeSpread& spread) {
  return {{"p50", spread.p50_us}, {"p99", spread.p99_us}, {"p99.9", spread.p999_us}, {"max", spread.max_us}};
}

Json tenths(const EngineMeasurement& measured, const auto& value) {
  return {{"first_tenth", value(measured.first_tenth)},
          {"middle_tenth", value(measured.middle_tenth)},
          {"last_tenth", value(measured.last_tenth)}};
}

Json json_of(const BenchResults& results, const BenchResult& result) {
  const EngineMeasurement& measured = result.measured;
  Json json{{"engine", result.engine},
            {"motion", name_of(result.motion)},
            {"diameter_mm", result.diameter_mm},
            {"spacing_mm", result.spacing_mm},
            {"threads", result.threads},
            {"points", result.points},
            {"timed", measured.is_whole_path ? "whole path" : "windows"},
            {"timed_cycles", measured.cycles},
            {"cycles_per_cpu_s", tenths(measured, [](const Stretch& part) { return part.cycles_per_cpu_s(); })},
            {"cycles_per_wall_s", tenths(measured, [](const Stretch& part) { return part.cycles_per_wall_s(); })},
            {"cpu_us", quantiles_of(measured.cpu)},
            {"wall_us", quantiles_of(measured.wall)},
            {"removed_per_cycle", per_cycle(measured.all.removed, measured.all)},
            {"tested_per_cycle", per_cycle(measured.all.tested, measured.all)},
            {"bytes", measured.memory_bytes},
            {"bytes_per_point", bytes_per_point(result)}};
  if (const BenchResult* reference = reference_of(results, result)) {
    const EngineMeasurement& base = reference->measured;
    json["ratio_to_reference"] = {{"first_tenth", ratio(measured.first_tenth, base.first_tenth)},
                                  {"middle_tenth", ratio(measured.middle_tenth, base.middle_tenth)},
                                  {"last_tenth", ratio(measured.last_tenth, base.last_tenth)}};
  }
  if (measured.is_whole_path) json["occupancy_hash"] = hex(measured.occupancy_hash);
  Json curve = Json::array();
  for (const Stretch& part : measured.curve) curve.push_back({part.begin, part.end, part.cycles_per_cpu_s()});
  json["curve_begin_end_cycles_per_cpu_s"] = std::move(curve);
  return json;
}

Json json_of(const BenchMillingResult& result) {
  const MillingWorkload& workload = result.workload;
  const EngineMeasurement& measured = result.measured;
  return {{"engine", result.engine},
          {"with_forces", workload.has_forces},
          {"diameter_mm", workload.diameter_mm},
          {"tilt_deg", workload.tilt_deg},
          {"step_mm", workload.step_mm},
          {"lever_mm", workload.lever_mm},
          {"spacing_mm", workload.spacing_mm},
          {"points", result.points},
          {"cycles", measured.cycles},
          {"cycles_per_cpu_s", measured.all.cycles_per_cpu_s()},
          {"cycles_per_wall_s", measured.all.cycles_per_wall_s()},
          {"cpu_us", quantiles_of(measured.cpu)},
          {"wall_us", quantiles_of(measured.wall)},
          {"removed_per_cycle", per_cycle(measured.all.removed, measured.all)},
          {"removed_mm3", measured.all.removed_mm3},
          {"tested_per_cycle", per_cycle(measured.all.tested, measured.all)},
          {"bytes", measured.memory_bytes}};
}

/// The setup and the way of a workload, as far as they decide what auto is.
std::string auto_engine(const DrillBit& bit, double spacing_mm, const MotionClass& way) {
  SessionSetup setup;
  setup.path = workload_path(3.0);
  setup.path.bit = bit;
  setup.volume.spacing_mm = spacing_mm;
  return name_of(chosen_engine(setup, way));
}

/// How long one engine took for a workload.
struct Taken {
  std::string engine;
  double time = 0.0;
};

/// Adds auto's choice where it is among those that were measured.
void add_choice(const AutoChoice& workload, const std::vector<Taken>& taken, std::vector<AutoChoice>& choices) {
  const auto own = std::ranges::find(taken, workload.engine, &Taken::engine);
  if (own == taken.end() || taken.size() < 2) return;
  const auto best = std::ranges::min_element(taken, {}, &Taken::time);
  choices.push_back(workload);
  choices.back().best = best->engine;
  choices.back().to_best = own->time / best->time;
}

}  // namespace

double BenchStepResult::median_wall_ms() const {
  return sorted_ms(repeats, &StepMeasurement::wall_ns)[repeats.size() / 2];
}
double BenchStepResult::min_wall_ms() const { return sorted_ms(repeats, &StepMeasurement::wall_ns).front(); }
double BenchStepResult::median_cpu_ms() const {
  return sorted_ms(repeats, &StepMeasurement::cpu_ns)[repeats.size() / 2];
}

const std::vector<BenchEngine>& bench_engines() {
  const auto factory = [](EngineKind kind) {
    return [kind](PointVolume& volume, const DrillBit& bit, const Material& material) {
      return make_engine(kind, volume, bit, material);
    };
  };
  static const std::vector<BenchEngine> engines{{"reference", factory(EngineKind::reference), false, false},
                                                {"arc", factory(EngineKind::arc), false, false},
                                                {"ring", factory(EngineKind::ring), true, true},
                                                {"leaf", factory(EngineKind::leaf), true, true, true},
                                                {"voxel", {}, true, true, true}};
  return engines;
}

const BenchResult* reference_of(const BenchResults& results, const BenchResult& result) {
  const auto found = std::find_if(results.runs.begin(), results.runs.end(), [&](const BenchResult& other) {
    return other.engine == bench_engines().front().name && other.motion == result.motion &&
           other.diameter_mm == result.diameter_mm && other.spacing_mm == result.spacing_mm;
  });
  return found == results.runs.end() ? nullptr : &*found;
}

std::vector<AutoChoice> auto_choices(const BenchResults& results) {
  std::vector<AutoChoice> choices;
  std::vector<const BenchResult*> runs;
  for (const BenchResult& run : results.runs) {
    if (run.measured.is_whole_path && run.threads == results.runs.front().threads) runs.push_back(&run);
  }
  while (!runs.empty()) {
    const BenchResult& first = *runs.front();
    std::vector<Taken> taken;
    std::erase_if(runs, [&](const BenchResult* run) {
      const bool is_same =
          run->motion == first.motion && run->diameter_mm == first.diameter_mm && run->spacing_mm == first.spacing_mm;
      if (is_same) taken.push_back({run->engine, static_cast<double>(run->measured.all.cpu_ns)});
      return is_same;
    });
    add_choice(
        {workload(first), first.spacing_mm,
         auto_engine(workload_bit(first.motion, first.diameter_mm), first.spacing_mm, workload_way(first.motion))},
        taken, choices);
  }
  std::vector<const BenchStepResult*> steps;
  for (const BenchStepResult& step : results.steps) {
    if (step.threads == results.steps.front().threads) steps.push_back(&step);
  }
  while (!steps.empty()) {
    const BenchStepResult& first = *steps.front();
    std::vector<Taken> taken;
    std::erase_if(steps, [&](const BenchStepResult* step) {
      const bool is_same = step->step == first.step && step->spacing_mm == first.spacing_mm;
      if (is_same) taken.push_back({step->engine, step->median_cpu_ms()});
      return is_same;
    });
    const DrillBit bit = first.step == burr_step().name ? burr_step().bit : sideways_step().bit;
    add_choice({first.step, first.spacing_mm, auto_engine(bit, first.spacing_mm, {})}, taken, choices);
  }
  return choices;
}

std::string bench_tables(const BenchResults& results, bool markdown) {
  const auto text = [&](const TextTable& table) { return markdown ? table.markdown() : table.aligned(); };
  std::string tables;
  if (!results.runs.empty()) {
    tables += "Cycles a second of the calling thread's CPU time:\n\n" + text(rates_table(results)) +
              "\nTime of one cycle, CPU of the calling thread and wall:\n\n" + text(times_table(results));
    const bool has_windows = std::any_of(results.runs.begin(), results.runs.end(),
                                         [](const BenchResult& result) { return !result.measured.is_whole_path; });
    if (has_windows) {
      tables += "\n\\* timed in windows in the middle of each tenth of the path, not over the whole path\n";
      if (!markdown) tables.erase(tables.rfind("\\*"), 1);
    }
  }
  if (!results.steps.empty()) {
    if (!tables.empty()) tables += "\n";
    tables += "One long step, every point occupied before:\n\n" + text(steps_table(results));
  }
  if (!results.millings.empty()) {
    if (!tables.empty()) tables += "\n";
    tables +=
        "A trembling hand mills the phantom's L3 at 50 mm/s with a ball burr, or turns it a degree a step; one thread:"
        "\n\n" +
        text(millings_table(results)) +
        "\nOthers, as they were measured on such a machine, not in this run: a 3 mm tool where not said, voxels of "
        "0.1 mm, solid bone, the thread's CPU time:\n\n" +
        text(peers_table());
  }
  if (const std::vector<AutoChoice> choices = auto_choices(results); !choices.empty()) {
    tables += "\nWhat the engine auto comes to, and its CPU time for all of the way against the fastest engine's:\n\n" +
              text(auto_table(choices));
  }
  return tables;
}

Json to_json(const BenchResults& results) {
  Json json{{"runs", Json::array()}, {"steps", Json::array()}, {"millings", Json::array()}, {"auto", Json::array()}};
  for (const BenchResult& result : results.runs) json["runs"].push_back(json_of(results, result));
  for (const BenchStepResult& result : results.steps) {
    json["steps"].push_back({{"step", result.step},
                             {"engine", result.engine},
                             {"spacing_mm", result.spacing_mm},
                             {"threads", result.threads},
                             {"median_wall_ms", result.median_wall_ms()},
                             {"min_wall_ms", result.min_wall_ms()},
                             {"median_cpu_ms_of_all_threads", result.median_cpu_ms()},
                             {"speed_up", speed_up(results, result)},
                             {"removed", result.repeats[0].removed},
                             {"tested", result.repeats[0].tested},
                             {"occupancy_hash", hex(result.repeats[0].occupancy_hash)}});
  }
  for (const BenchMillingResult& result : results.millings) json["millings"].push_back(json_of(result));
  if (!results.millings.empty()) {
    for (const PeerMilling& peer : kPeers) {
      json["peers"].push_back({{"system", peer.system},
                               {"cycles_per_s", peer.cycles_a_second},
                               {"p50_p99_ms", peer.times_ms},
                               {"what", peer.what}});
    }
  }
  for (const AutoChoice& choice : auto_choices(results)) {
    json["auto"].push_back({{"workload", choice.workload},
                            {"spacing_mm", choice.spacing_mm},
                            {"engine", choice.engine},
                            {"best", choice.best},
                            {"to_best", choice.to_best}});
  }
  return json;
}

}  // namespace spinaltap
