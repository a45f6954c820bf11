#include "core/session/operator/drilled_hole.h"

#include <utility>

namespace spinaltap {

std::vector<std::vector<Pose>> cutting_ways(std::span<const ToolInput> inputs, const DrillBit& bit, double max_jump_mm,
                                            std::optional<Pose>& last) {
  std::vector<std::vector<Pose>> ways;
  std::vector<Pose> way;
  const auto end_way = [&] {
    if (!way.empty()) ways.push_back(std::exchange(way, {}));
  };
  if (last) way.push_back(*last);
  for (const ToolInput& input : inputs) {
    const std::optional<Pose> pose = sound_pose(input.pose, bit);
    if (!pose) continue;
    if (!way.empty()) {
      const bool is_jump = longest_way_mm(way.back(), *pose, bit.length_mm) > max_jump_mm;
      if (is_jump || !input.spindle_on) end_way();
    }
    if (input.spindle_on) way.push_back(*pose);
  }
  last = way.empty() ? std::nullopt : std::optional(way.back());
  end_way();
  return ways;
}

DrilledHole drilled_hole(std::span<const ToolInput> inputs, const DrillBit& bit, double max_jump_mm) {
  std::optional<Pose> from_nowhere;
  return {bit, cutting_ways(inputs, bit, max_jump_mm, from_nowhere)};
}

}  // namespace spinaltap
