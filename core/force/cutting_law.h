#pragma once

#include "core/force/drill_force.h"
#include "core/points/material.h"
#include "core/tool/drill_bit.h"

namespace spinaltap {

/// The hole that a bit stands in: what its margins rub on and how full its flutes are.
struct DrilledDepth {
  double depth_mm = 0.0;
  double energy_mpa = 0.0;  ///< mean energy of cutting its wall
};

/// What meets a tool: the energy that an advance cuts, by the material's table, and the chisel edge's pressure.
struct EngagedBone {
  double energy_n = 0.0;  ///< N·mm per mm of advance, at the reference feed
  double chisel_mpa = 0.0;
  DrilledDepth hole = {};
};

/// A material's cutting law for one tool: all that follows from the tool's shape, in a few numbers. docs/forces.md has
/// the laws.
///
/// Power: the lips take thrust by one share of the force along their cut. Mechanistic: at each radius of the lips
/// Merchant's shear plane (J. Appl. Phys. 1945, with the angle of Ernst & Merchant) at the normal rake that helix, web
/// and point angle leave there (Galloway 1957, as Lee, Gozen & Ozdoganlar, J. Biomech. 2012, use it for bone), and the
/// speed there; behind a worn lip the chisel edge's pressure on the flat; on the margins a share of the energy of
/// cutting as pressure; with depth, chips in the flutes. Burrs, profiles and screws have no helix: a rake of 0.
class ToolLaw {
 public:
  /// Throws Error on a bad bit or material.
  ToolLaw(const DrillBit& bit, const Material& material);

  /// `rpm` above 0.
  CuttingResistance resistance(const EngagedBone& bone, double rpm) const noexcept;
  /// Energy of cutting over that of the material's table, by the lips' rakes and speed: what torque and lateral force
  /// go with. 1 by the power law.
  double energy_factor(double rpm) const noexcept;
  /// Torque of the lips with the chips in the flutes, over that without.
  double chips_factor(double depth_mm) const noexcept;
  /// Thrust of the lips over twice their torque over the bit's radius.
  double lip_thrust_share() const { return lip_thrust_share_; }
  double section_mm2() const { return section_mm2_; }
  /// Half the width of the chisel edge, mm.
  double chisel_radius_mm() const { return chisel_radius_mm_; }
  /// A feed per turn times the energy at it over that at the reference feed, mm. 0 at feeds not above 0.
  double feed_times_factor_mm(double feed_mm) const noexcept;

 private:
  void take_lips(const DrillBit& bit, const Material& material);
  double speed_factor(double rpm) const noexcept;

  double radius_mm_;
  bool is_plate_;
  double stroke_mm_;
  double section_mm2_;
  double chisel_radius_mm_;
  double reference_feed_mm_;
  double feed_exponent_;
  double lip_thrust_share_;
  double torque_factor_ = 1.0;
  double speed_exponent_ = 0.0;
  double reference_rpm_ = 1.0;
  double flank_mm2_ = 0.0;          ///< of both flats, seen along the axis, times pressure over energy
  double flank_torque_mm_ = 0.0;    ///< torque over thrust of them
  double margin_mm2_ = 0.0;         ///< torque over energy and depth
  double chip_share_per_mm_ = 0.0;  ///< more torque a mm of depth
};

/// Thrust and torque of a bit that advances along its axis in an even block, by the law alone: what DrillForces comes
/// to where the whole section cuts. `density_g_cm3` as the material's density calibration has it for `hu`; `depth_mm`
/// of the hole behind it. Throws Error on a bad bit or material.
CuttingResistance resistance_of_block(const DrillBit& bit, const Material& material, double hu, double rpm = 1250.0,
                                      double depth_mm = 0.0);

}  // namespace spinaltap
