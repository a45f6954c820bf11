#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/session/operator/operator.h"

namespace spinaltap {

/// What a bit drilled: the ways on which it cut, each as its poses (patient LPS, mm), straight from one to the next
/// (see SweptBit); of one pose alone it took what it holds there. Points, voxels, grids, meshes and pictures all take
/// their hole from here.
struct DrilledHole {
  DrillBit bit;
  std::vector<std::vector<Pose>> ways;
};

/// What of a cycle decides the hole: where the tool came to, and whether it cut.
struct ToolMove {
  Pose pose;  ///< patient LPS
  bool spindle_on = true;
};

/// The ways on which a bit cut. As DrillSession has it: a bit that does not turn takes nothing, nor do ways of the tip
/// or the base longer than `max_jump_mm`; poses that are not sound are passed over. `last`: where the bit stood before
/// the inputs, nothing where it has come from nowhere; then where it stands after them.
std::vector<std::vector<Pose>> cutting_ways(std::span<const ToolInput> inputs, const DrillBit& bit, double max_jump_mm,
                                            std::optional<Pose>& last);
std::vector<std::vector<Pose>> cutting_ways(std::span<const ToolMove> moves, const DrillBit& bit, double max_jump_mm,
                                            std::optional<Pose>& last);
/// The hole of a bit that has come from nowhere.
DrilledHole drilled_hole(std::span<const ToolInput> inputs, const DrillBit& bit, double max_jump_mm);

}  // namespace spinaltap
