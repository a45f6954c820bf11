#pragma once

#include "core/heat/thermal_bone.h"

namespace spinaltap {

/// The part of a shear plane's heat that stays in the bone; the chip takes the rest. Weiner's relation (1955) for a
/// straight plane in steady cutting, heat flowing across the cut alone: with Y = `quarter_number` = Pe tan φ / 4 it is
/// erf(√Y) / 4Y + (1 + Y) erfc(√Y) - e^-Y (1 / 2√Y + √Y) / √π. 1 at 0, falls to 1 / 4Y. NaN below 0.
double shear_plane_share(double quarter_number) noexcept;

/// How a bit cuts at one moment. What a session's cycle tells.
struct CuttingState {
  double torque_n_mm = 0.0;
  double thrust_n = 0.0;
  double rpm = 0.0;
  double feed_mm_per_turn = 0.0;
  double density_g_cm3 = 0.0;  ///< of the bone ahead
};

/// Where the power of cutting goes.
struct CuttingHeat {
  double power_w = 0.0;     ///< torque times speed of turning, and thrust times feed; all of it becomes heat
  double peclet = 0.0;      ///< speed of the lip times depth of its cut, over the diffusivity
  double bone_share = 0.0;  ///< the rest goes with the chips
  double bone_w = 0.0;      ///< what the bone around the hole gets
};

/// Heat of a bit with two lips that each cut half the feed. Heat comes evenly off the area that they sweep, so the
/// speed is that at 2/3 of the radius. The share depends, as Soriano (2013) measured, on speed of turning times feed of
/// an edge times diameter. 0 all over where nothing turns, or a number is none.
CuttingHeat cutting_heat(const ThermalBone& bone, double diameter_mm, const CuttingState& state) noexcept;

}  // namespace spinaltap
