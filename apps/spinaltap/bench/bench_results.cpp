#include "apps/spinaltap/bench/bench_results.h"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "apps/report/text.h"
#include "apps/report/text_table.h"
#include "core/base/text_writer.h"
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
  if (measured.is_whole_path) json["alive_hash"] = hex(measured.alive_hash);
  Json curve = Json::array();
  for (const Stretch& part : measured.curve) curve.push_back({part.begin, part.end, part.cycles_per_cpu_s()});
  json["curve_begin_end_cycles_per_cpu_s"] = std::move(curve);
  return json;
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
                                                {"leaf", factory(EngineKind::leaf), true, true}};
  return engines;
}

const BenchResult* reference_of(const BenchResults& results, const BenchResult& result) {
  const auto found = std::find_if(results.runs.begin(), results.runs.end(), [&](const BenchResult& other) {
    return other.engine == bench_engines().front().name && other.motion == result.motion &&
           other.diameter_mm == result.diameter_mm && other.spacing_mm == result.spacing_mm;
  });
  return found == results.runs.end() ? nullptr : &*found;
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
    tables += "One long step, every point alive before:\n\n" + text(steps_table(results));
  }
  return tables;
}

Json to_json(const BenchResults& results) {
  Json json{{"runs", Json::array()}, {"steps", Json::array()}};
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
                             {"alive_hash", hex(result.repeats[0].alive_hash)}});
  }
  return json;
}

}  // namespace spinaltap
