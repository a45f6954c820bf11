#include "core/tool/tool_speed.h"

#include "core/base/text_writer.h"
#include "core/tool/bit_shape.h"

namespace spinaltap {
namespace {

constexpr double kSecondsAMinute = 60.0;

bool is_within(double value, double low, double high) { return value >= low && value <= high; }

/// "; 120 mm/min are 2 mm/s", where a value in another unit would be within the range.
std::string meant(double value, double per, const char* unit, const char* ours, double low, double high) {
  const double as_ours = value * per;
  if (!is_within(as_ours, low, high)) return {};
  return joined(": is it in ", unit, "? ", short_text(value), " ", unit, " are ", short_text(as_ours), " ", ours);
}

}  // namespace

std::vector<std::string> speed_warnings(const DrillBit& bit, const std::vector<double>& feeds_mm_s,
                                        std::optional<double> rpm) {
  const ToolSpeedRange& range = traits_of(bit.shape).speeds;
  std::vector<std::string> warnings;
  for (const double feed_mm_s : feeds_mm_s) {
    if (is_within(feed_mm_s, range.min_feed_mm_s, range.max_feed_mm_s)) continue;
    std::string words = joined("a feed of ", short_text(feed_mm_s), " mm/s is beyond this tool's ",
                               short_text(range.min_feed_mm_s), " to ", short_text(range.max_feed_mm_s), " mm/s");
    words += feed_mm_s > range.max_feed_mm_s
                 ? meant(feed_mm_s, 1.0 / kSecondsAMinute, "mm/min", "mm/s", range.min_feed_mm_s, range.max_feed_mm_s)
                 : meant(feed_mm_s, 1000.0, "m/s", "mm/s", range.min_feed_mm_s, range.max_feed_mm_s);
    warnings.push_back(words);
  }
  if (rpm && *rpm != 0.0 && !bit.is_plate() && !is_within(*rpm, range.min_rpm, range.max_rpm)) {
    std::string words = joined("a spindle at ", short_text(*rpm), " rpm is beyond this tool's ",
                               short_text(range.min_rpm), " to ", short_text(range.max_rpm), " rpm");
    if (*rpm < range.min_rpm) {
      const std::string turns = meant(*rpm, kSecondsAMinute, "turns a second", "rpm", range.min_rpm, range.max_rpm);
      words += turns.empty() ? meant(*rpm, 1000.0, "1000 rpm", "rpm", range.min_rpm, range.max_rpm) : turns;
    }
    warnings.push_back(words);
  }
  return warnings;
}

}  // namespace spinaltap
