#pragma once

#include <memory>
#include <span>

#include "core/engine/drill_engine.h"
#include "core/points/living_bone.h"

namespace spinaltap {

/// What makes a bit cut: how fast it turns and how fast it moves.
struct Spindle {
  double rpm = 1250.0;       ///< 0: off; of a saw: strokes to and fro a minute, its feed per turn that per stroke
  bool is_clockwise = true;  ///< seen from the base to the tip, as drills turn
};

/// What the bone in front of a bit asks of a feed: thrust and torque for any feed per turn. An operator that pushes
/// finds its feed from it.
struct FeedResistance {
  double lips_n = 0.0;             ///< thrust of the lips at the reference feed
  double lips_n_mm = 0.0;          ///< torque at the reference feed
  double chisel_n = 0.0;           ///< thrust of the chisel edge, at any feed above 0
  double reference_feed_mm = 0.1;  ///< per turn
  double feed_exponent = 0.3;

  /// N. 0 at a feed of 0; rises with the feed.
  double thrust_n(double feed_mm_per_turn) const noexcept;
  /// N·mm, about the bit's axis.
  double torque_n_mm(double feed_mm_per_turn) const noexcept;
};

/// Forces on the bit after a cycle. Vectors: patient LPS, N; what the operator that holds the bit feels.
struct DrillForce {
  Vec3 force_n = Vec3::Zero();    ///< all of it: against the feed, sideways, and contact
  double thrust_n = 0.0;          ///< of cutting, against the bit's axis: lips and chisel edge
  double torque_n_mm = 0.0;       ///< of cutting, about the bit's axis
  Vec3 lateral_n = Vec3::Zero();  ///< of cutting, across the axis
  Vec3 contact_n = Vec3::Zero();  ///< of touching without cutting
  double feed_mm_per_turn = 0.0;
  double tip_density_g_cm3 = 0.0;  ///< of the living bone just ahead of the chisel edge; 0 where there is none
  FeedResistance resistance;
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

  /// After `step` has moved the bit to `pose` (patient LPS) within `dt_s`. With the spindle off the engine takes no
  /// step: then `result` is empty and the forces are those of contact.
  DrillForce update(const StepResult& result, const Pose& pose, double dt_s, const Spindle& spindle) noexcept;

  /// Back to the state after construction.
  void reset() noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// What the bone asks where cutting takes `energy_n` (N·mm per mm of advance) at the reference feed and the chisel edge
/// meets `chisel_mpa`.
FeedResistance resistance_of_cut(const DrillBit& bit, const Material& material, double energy_n, double chisel_mpa);

/// Thrust and torque of a bit that advances along its axis in an even block, by the model alone: what DrillForces comes
/// to where the whole section cuts. `density_g_cm3` as the material's density calibration has it for `hu`.
FeedResistance resistance_of_block(const DrillBit& bit, const Material& material, double hu);

}  // namespace spinaltap
