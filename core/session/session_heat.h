#pragma once

#include <limits>

#include "core/heat/thermal_bone.h"

namespace spinaltap {

/// The temperature of the bone beside the hole, live (HoleHeat): docs/heat.md.
struct HeatOptions {
  ThermalBone bone = {};
  bool is_irrigated = false;  ///< the hole's wall gives heat off to water
  double distance_mm = 0.5;   ///< from the wall, where the temperature is told
  double limit_c = 47.0;      ///< above it there is an event: heat_limit
};
/// Rejects options that are not numbers or make no sense.
void check_heat_options(const HeatOptions& options);

/// What a cycle's heat came to; temperatures and the depth are no numbers where the session works out none.
struct CycleHeat {
  double bone_w = 0.0;  ///< that the bone gets: cutting_heat()
  /// Of the hottest place beside the hole, up to a second old where the hole is 40 mm deep.
  double temperature_c = std::numeric_limits<double>::quiet_NaN();
  double max_temperature_c = std::numeric_limits<double>::quiet_NaN();  ///< so far
  double max_depth_mm = std::numeric_limits<double>::quiet_NaN();       ///< where: along the path, 0 at the entry
};

}  // namespace spinaltap
