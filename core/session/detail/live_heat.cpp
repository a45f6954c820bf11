#include "core/session/detail/live_heat.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/heat/cutting_heat.h"

namespace spinaltap {
namespace {

HoleHeatOptions hole_options(const DrillPath& path, const HeatOptions& options) {
  constexpr double kBeyondMm = 20.0;  // operators may go further than the target
  constexpr double kMaxMm = 1000.0;   // that HoleHeat takes
  if (path.bit.is_plate()) fail("session: expected a bit for heat, found a plate, which drills no hole");
  return {.radius_mm = path.bit.radius_mm(),
          .length_mm = std::min(path.length_mm() + kBeyondMm, kMaxMm),
          .distance_mm = options.distance_mm,
          .wall_transfer_w_mm2_k = options.is_irrigated ? options.bone.water_w_mm2_k : 0.0,
          .wall_conductivity_w_mm_k = options.bone.cortical.conductivity_w_mm_k};
}

}  // namespace

void check_heat_options(const HeatOptions& options) {
  constexpr double kMaxDistanceMm = 20.0;
  check_thermal_bone(options.bone);
  if (!(options.distance_mm > 0.0 && options.distance_mm <= kMaxDistanceMm)) {
    fail("session: expected heat at above 0 to ", kMaxDistanceMm, " mm from the wall, found ", options.distance_mm,
         " mm");
  }
  if (!(options.limit_c > options.bone.temperature_c) || !std::isfinite(options.limit_c)) {
    fail("session: expected a limit above the bone's own ", options.bone.temperature_c, " °C, found ", options.limit_c,
         " °C");
  }
}

LiveHeat::LiveHeat(const DrillPath& path, const HeatOptions& options)
    : options_(options),
      diameter_mm_(path.bit.diameter_mm),
      wall_back_mm_(wall_back_mm(path.bit)),
      curve_(path),
      hole_(hole_options(path, options)) {}

CycleHeat LiveHeat::begin() const {
  return {.bone_w = 0.0,
          .temperature_c = options_.bone.temperature_c,
          .max_temperature_c = options_.bone.temperature_c,
          .max_depth_mm = 0.0};
}

CycleHeat LiveHeat::update(const Cycle& cycle, double dt_s, double rpm, EventLog& log) noexcept {
  constexpr double kBackK = 0.5;  // a heat that flickers about the limit is one event
  const DrillForce& force = cycle.force;
  CycleHeat heat;
  heat.bone_w = cutting_heat(options_.bone, diameter_mm_,
                             {force.torque_n_mm, force.thrust_n, rpm, force.feed_mm_per_turn, force.tip_density_g_cm3})
                    .bone_w;
  hole_.update(cycle.depth_mm - wall_back_mm_, heat.bone_w, dt_s, options_.bone.at(force.tip_density_g_cm3));
  const HottestPlace& now = hole_.now();
  heat.temperature_c = options_.bone.temperature_c + now.rise_k;
  heat.max_temperature_c = options_.bone.temperature_c + hole_.ever().rise_k;
  heat.max_depth_mm = hole_.ever().depth_mm;
  over_.update(heat.temperature_c, options_.limit_c, kBackK,
               {EventKind::heat_limit, cycle.index, cycle.time_s, cycle.depth_mm, curve_.at_mm(now.depth_mm),
                heat.temperature_c},
               log);
  return heat;
}

}  // namespace spinaltap
