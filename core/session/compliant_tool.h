#pragma once

#include "core/base/geometry.h"
#include "core/session/cycle.h"
#include "core/session/session_setup.h"
#include "core/tool/drill_bit.h"

namespace spinaltap {

/// Rejects values that are not finite or make no sense.
void check_compliance(const ComplianceOptions& options);

/// Where the tip of a tool really is, and how fast it turns, when its chuck is held where it is asked to be.
///
/// Motor: its speed goes down with the torque in a line, from the spindle's to 0 at the torque of stall; once it stands
/// it stays so until the tool is drawn back by half a millimetre or switched off. Bit: a cantilever from its chuck to
/// where bone guides it, of stiffness 3 E I / L³ at its end, bent by the forces across its axis; before its tip has
/// bitten, also by the slope of the surface under its thrust, less friction (it walks), and from then on led by its
/// hole: it goes on where its end points, and turns aside by the force across it over its thrust, as bone gives way to
/// either. No mass: what bends it is there within 10 ms.
class CompliantTool {
 public:
  /// Throws Error as check_bit() and check_compliance() do.
  CompliantTool(const DrillBit& bit, const ComplianceOptions& options);

  /// What the tool met in the cycle before.
  struct Met {
    DrillForce force = {};
    TipPlace tip = {};
    Vec3 into_bone = Vec3::Zero();  ///< unit, across the surface under the tip; zero where that is not known
    double advance_mm = 0.0;        ///< of the commanded tip along its axis since then
  };
  /// The real pose for a commanded one, which is `dt_s` after the last.
  Pose real_pose(const Pose& commanded, const Met& met, double dt_s) noexcept;
  /// The spindle as it turns under the torque of the cycle before.
  Spindle real_spindle(const Spindle& commanded, const Met& met, double dt_s) noexcept;

  /// How far the real tip is off the commanded one, mm, patient LPS, across the axis.
  const Vec3& off_mm() const { return off_mm_; }
  bool is_stalled() const { return is_stalled_; }
  /// Of the bit's end with no bone around, N/mm.
  double stiffness_n_mm(double guided_mm) const noexcept;

 private:
  /// What of the bit is not guided by bone.
  double free_mm(double guided_mm) const noexcept;

  ComplianceOptions options_;
  double length_mm_;
  double bending_n_mm2_;  ///< E I
  Vec3 off_mm_ = Vec3::Zero();
  double speed_share_ = 1.0;  ///< of the spindle's
  bool is_stalled_ = false;
  double drawn_back_mm_ = 0.0;
};

}  // namespace spinaltap
