#pragma once

#include <array>
#include <memory>
#include <span>

#include "core/engine/drill_engine.h"
#include "core/force/cutting_law.h"
#include "core/force/drill_force.h"
#include "core/points/occupied_bone.h"

namespace spinaltap {

/// Turns what a step removed into forces: docs/forces.md. Removal comes in bursts, disc by disc; the work is therefore
/// averaged over the last way of the tip, some spacings long, so that the forces depend neither on the step's length
/// nor on the points' spacing. One object belongs to one engine; `update` allocates, locks and logs nothing, and its
/// result is the same for every engine and number of threads.
class DrillForces {
 public:
  /// `bone`: what the engine drills; it must outlive this. Throws Error on a bad bit or material.
  DrillForces(const OccupiedBone& bone, const DrillBit& bit, const Material& material);
  /// Of volumes end to end along one path, as BonePoints takes them.
  DrillForces(std::span<const PointVolume> volumes, const DrillBit& bit, const Material& material);
  ~DrillForces();
  DrillForces(DrillForces&&) noexcept;
  DrillForces& operator=(DrillForces&&) noexcept;

  /// After `step` has moved the bit to `pose` (patient LPS) within `dt_s`. With the spindle off the engine takes no
  /// step: then `result` is empty and the forces are those of contact.
  DrillForce update(const StepResult& result, const Pose& pose, double dt_s, const Spindle& spindle) noexcept;

  /// Back to the state after construction.
  void reset() noexcept;
  /// From now on forces have DrillForce::contact, also of a wall that nothing is pressed on yet: a microsecond a cycle.
  void report_contact() noexcept;
  /// From now on forces have no DrillForce::support_n, and force_n is without it: a microsecond and a half less a
  /// cycle.
  void leave_out_support() noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace spinaltap
