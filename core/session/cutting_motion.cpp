#include "core/session/cutting_motion.h"

namespace spinaltap {

ToolMove cutting_move(const Cycle& cycle, const SessionOptions& options) noexcept {
  return {options.compliance.is_on ? cycle.pose : cycle.input.pose,
          cycle.input.spindle_on && options.spindle.rpm > 0.0};
}

ToolInput cutting_input(const Cycle& cycle, const SessionOptions& options) {
  const ToolMove move = cutting_move(cycle, options);
  ToolInput input = cycle.input;
  input.spindle_on = move.spindle_on;
  input.pose = move.pose;
  return input;
}

DrilledHole hole_of(std::span<const ToolInput> inputs, const SessionSetup& setup) {
  return drilled_hole(inputs, setup.path.bit, setup.options.max_jump_mm);
}

}  // namespace spinaltap
