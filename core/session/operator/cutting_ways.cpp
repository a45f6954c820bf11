#include "core/session/operator/cutting_ways.h"

#include <algorithm>
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
    const std::optional<Pose> pose = sound_pose(input.pose);
    if (!pose) continue;
    if (!way.empty()) {
      const Vec3 tip_way_mm = pose->tip_mm - way.back().tip_mm;
      const Vec3 base_way_mm = tip_way_mm - bit.length_mm * (pose->axis - way.back().axis);
      const bool is_jump = std::max(tip_way_mm.norm(), base_way_mm.norm()) > max_jump_mm;
      if (is_jump || !input.spindle_on) end_way();
    }
    if (input.spindle_on) way.push_back(*pose);
  }
  last = way.empty() ? std::nullopt : std::optional(way.back());
  end_way();
  return ways;
}

}  // namespace spinaltap
