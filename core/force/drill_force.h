#pragma once

#include <array>

#include "core/base/geometry.h"

namespace spinaltap {

/// What the bone in front of a bit asks of a feed: thrust and torque for any feed per turn. An operator that pushes
/// finds its feed from it.
struct CuttingResistance {
  double lips_n = 0.0;             ///< thrust of the lips at the reference feed
  double lips_n_mm = 0.0;          ///< torque at the reference feed
  double chisel_n = 0.0;           ///< thrust of the chisel edge and of worn flanks, at any feed above 0
  double reference_feed_mm = 0.1;  ///< per turn
  double feed_exponent = 0.3;
  double rub_n_mm = 0.0;  ///< torque of worn flanks and of margins in their hole, at any feed above 0

  /// N. 0 at a feed of 0; rises with the feed.
  double thrust_n(double feed_mm_per_turn) const noexcept;
  /// N·mm, about the bit's axis.
  double torque_n_mm(double feed_mm_per_turn) const noexcept;
  /// N·mm: the part of it that is not the lips'.
  double rubbing_n_mm(double feed_mm_per_turn) const noexcept;
};

/// What makes a bit cut: how fast it turns and how fast it moves.
struct Spindle {
  double rpm = 1250.0;       ///< 0: off; of a saw: strokes to and fro a minute, its feed per turn that per stroke
  bool is_clockwise = true;  ///< seen from the base to the tip, as drills turn
};

/// How bone holds a tool by contact and by its hole's wall, for who moves it by forces: as springs, one for each place
/// that is touched.
struct ContactStiffness {
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
  double tip_density_g_cm3 = 0.0;  ///< of the occupied bone just ahead of the chisel edge; 0 where there is none
  CuttingResistance resistance;
  ContactStiffness contact;  ///< zero unless asked for: DrillForces::report_contact()
};

}  // namespace spinaltap
