#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/session/operator/operator.h"

namespace spinaltap {

/// The ways on which a bit cut, each as its poses, straight from one to the next (see SweptBit). As DrillSession has
/// it: a bit that does not turn takes nothing, nor do ways of the tip or the base longer than `max_jump_mm`; poses that
/// are not sound are passed over. `last`: where the bit stood before the inputs, nothing where it has come from
/// nowhere; then where it stands after them.
std::vector<std::vector<Pose>> cutting_ways(std::span<const ToolInput> inputs, const DrillBit& bit, double max_jump_mm,
                                            std::optional<Pose>& last);

}  // namespace spinaltap
