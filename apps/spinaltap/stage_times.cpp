#include "apps/spinaltap/stage_times.h"

#include <sys/resource.h>

#include "apps/spinaltap/command.h"
#include "core/base/text_writer.h"

namespace spinaltap {
namespace {

std::string seconds_text(double seconds) { return fixed_text(seconds, seconds < 9.95 ? 1 : 0) + " s"; }

/// The most memory that the process has had so far, bytes.
double most_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

Json json_of(const StageTime& time) { return {{"wall_s", time.wall_s}, {"processor_s", time.processor_s}}; }

}  // namespace

Json report_times(const StageClock& clock) {
  std::string words;
  Json stages = Json::array();
  for (const StageTime& time : clock.times()) {
    words += (words.empty() ? "" : ", ") + time.name + " " + seconds_text(time.wall_s);
    stages.push_back({{"stage", time.name}});
    stages.back().update(json_of(time));
  }
  const StageTime total = clock.total();
  const double memory = most_memory();
  print_figure("took", seconds_text(total.wall_s) + " (" + seconds_text(total.processor_s) + " of processor time, " +
                           fixed_text(1e-9 * memory, 2) + " GB of memory at most): " + words);
  return {{"stages", stages}, {"total", json_of(total)}, {"most_memory_bytes", memory}};
}

}  // namespace spinaltap
