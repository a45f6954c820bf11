#pragma once

#include <array>
#include <memory>
#include <span>

#include "core/base/statistics.h"
#include "core/engine/drill_engine.h"
#include "core/force/cutting_law.h"
#include "core/points/living_bone.h"

namespace spinaltap {

/// What makes a bit cut: how fast it turns and how fast it moves.
struct Spindle {
  double rpm = 1250.0;       ///< 0: off; of a saw: strokes to and fro a minute, its feed per turn that per stroke
  bool is_clockwise = true;  ///< seen from the base to the tip, as drills turn
};

/// How bone holds a tool by contact and by its hole's wall, for who moves it by forces: as springs, one for each place
/// that is touched.
struct ToolHold {
  Vec3 moment_n_mm = Vec3::Zero();  ///< of contact and wall on the tool about its tip, patient LPS
  /// Force (N) and moment about the tip (N·mm) against a small way of the tip (mm) and a small turn (rad): 6 by 6, row
  /// by row, symmetric, without negative eigenvalues; patient LPS.
  std::array<double, 36> stiffness = {};
};

/// Forces on the bit after a cycle. Vectors: patient LPS, N; what the operator that holds the bit feels.
struct DrillForce {
  Vec3 force_n = Vec3::Zero();  ///< all of it: against the feed, sideways, and contact
  double thrust_n = 0.0;        ///< of cutting, against the bit's axis: lips and chisel edge
  double torque_n_mm = 0.0;     ///< of cutting, about the bit's axis
  /// 5 % and 95 % of thrust and torque, as sources differ; see ForceBand.
  Interval thrust_band_n = {}, torque_band_n_mm = {};
  Vec3 lateral_n = Vec3::Zero();  ///< of cutting, across the axis
  Vec3 contact_n = Vec3::Zero();  ///< of touching without cutting
  Vec3 support_n = Vec3::Zero();  ///< of its hole's wall, which holds a turning drill that is pushed sideways
  double feed_mm_per_turn = 0.0;
  double tip_density_g_cm3 = 0.0;  ///< of the living bone just ahead of the chisel edge; 0 where there is none
  FeedResistance resistance;
  ToolHold hold;  ///< zero unless asked for: DrillForces::tell_hold()
};

/// Turns what a step removed into forces: docs/forces.md. Removal comes in bursts, disc by disc; the work is therefore
/// averaged over the last way of the tip, some spacings long, so that the forces depend neither on the step's length
/// nor on the points' spacing. One object belongs to one engine; `update` allocates, locks and logs nothing, and its
/// result is the same for every engine and number of threads.
class DrillForces {
 public:
  /// `bone`: what the engine drills; it must outlive this. Throws Error on a bad bit or material.
  DrillForces(const LivingBone& bone, const DrillBit& bit, const Material& material);
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
  /// From now on forces have DrillForce::hold, also of a wall that nothing is pressed on yet: a microsecond a cycle.
  void tell_hold() noexcept;
  /// From now on forces have no DrillForce::support_n, and force_n is without it: a microsecond and a half less a
  /// cycle.
  void leave_out_support() noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace spinaltap
