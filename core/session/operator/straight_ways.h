#pragma once

#include <memory>
#include <span>
#include <vector>

#include "core/session/operator/operator.h"

namespace spinaltap {

/// A way of a bit along its own axis; patient LPS, mm.
struct BitWay {
  Pose start;
  Pose end;  ///< of the same axis
};

/// The ways along straight lines that took all a bit took on `inputs`, to within some `tolerance_mm` sideways: poses on
/// nearly one line become one way, and of a tool that widens towards its base (drills, screws) the deepest pose on a
/// line is all that counts. Many thousand cycles of a steady operator become one way, those of a trembling operator
/// some hundred. Poses with the spindle off, and those that are not finite, took nothing; nor did ways of the tip or
/// the base longer than `max_jump_mm`. As DrillSession has it.
class StraightWays {
 public:
  StraightWays(const DrillBit& bit, double max_jump_mm, double tolerance_mm = 0.02);
  ~StraightWays();
  StraightWays(StraightWays&&) noexcept;
  StraightWays& operator=(StraightWays&&) noexcept;

  /// The next of the inputs.
  void add(const ToolInput& input);
  /// Of all so far.
  std::vector<BitWay> ways() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};
/// The same of all of some inputs.
std::vector<BitWay> straight_ways(std::span<const ToolInput> inputs, const DrillBit& bit, double max_jump_mm,
                                  double tolerance_mm = 0.02);

}  // namespace spinaltap
