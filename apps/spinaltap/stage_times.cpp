#include "apps/spinaltap/stage_times.h"

#include "apps/spinaltap/command.h"
#include "core/base/text_writer.h"

namespace spinaltap {
namespace {

std::string seconds_text(double seconds) { return fixed_text(seconds, seconds < 9.95 ? 1 : 0) + " s"; }

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
  print_figure("took",
               seconds_text(total.wall_s) + " (" + seconds_text(total.processor_s) + " of processor time): " + words);
  return {{"stages", stages}, {"total", json_of(total)}};
}

}  // namespace spinaltap
