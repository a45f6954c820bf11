#include "core/session/operator/drilled_hole.h"

#include <utility>

namespace spinaltap {
namespace {

template <class Move>
std::vector<std::vector<Pose>> ways_of(std::span<const Move> moves, const DrillBit& bit, double max_jump_mm,
                                       std::optional<Pose>& last) {
  std::vector<std::vector<Pose>> ways;
  std::vector<Pose> way;
  const auto end_way = [&] {
    if (!way.empty()) ways.push_back(std::exchange(way, {}));
  };
  if (last) way.push_back(*last);
  for (const Move& move : moves) {
    const std::optional<Pose> pose = valid_pose(move.pose, bit);
    if (!pose) continue;
    if (!way.empty()) {
      const bool is_jump = max_displacement_mm(way.back(), *pose, bit.length_mm) > max_jump_mm;
      if (is_jump || !move.spindle_on) end_way();
    }
    if (move.spindle_on) way.push_back(*pose);
  }
  last = way.empty() ? std::nullopt : std::optional(way.back());
  end_way();
  return ways;
}

}  // namespace

std::vector<std::vector<Pose>> cutting_ways(std::span<const ToolInput> inputs, const DrillBit& bit, double max_jump_mm,
                                            std::optional<Pose>& last) {
  return ways_of(inputs, bit, max_jump_mm, last);
}

std::vector<std::vector<Pose>> cutting_ways(std::span<const ToolMove> moves, const DrillBit& bit, double max_jump_mm,
                                            std::optional<Pose>& last) {
  return ways_of(moves, bit, max_jump_mm, last);
}

DrilledHole drilled_hole(std::span<const ToolInput> inputs, const DrillBit& bit, double max_jump_mm) {
  std::optional<Pose> from_nowhere;
  return {bit, cutting_ways(inputs, bit, max_jump_mm, from_nowhere)};
}

}  // namespace spinaltap
