#include "vdb/heat/drilling_heat.h"

#include <cmath>

#include "core/base/error.h"

namespace spinaltap {

std::vector<HeatStep> heat_steps(std::span<const RecordedCycle> cycles, const DrillBit& bit, double rpm,
                                 const ThermalBone& bone) {
  std::vector<HeatStep> steps;
  steps.reserve(cycles.size());
  for (const RecordedCycle& cycle : cycles) {
    HeatStep step{{cycle.tip_mm, cycle.axis}, cycle.dt_s, 0.0};
    if (cycle.spindle_on != 0) {
      const CuttingState state{cycle.torque_n_mm, cycle.thrust_n, rpm, cycle.feed_mm_per_turn, cycle.tip_density_g_cm3};
      step.bone_w = cutting_heat(bone, bit.diameter_mm, state).bone_w;
    }
    steps.push_back(step);
  }
  return steps;
}

DrillingHeat run_drilling_heat(HeatGrid& grid, const DrillBit& bit, std::span<const HeatStep> steps,
                               const DrillingHeatOptions& options, const Progress& progress) {
  if (bit.is_plate()) fail("heat: expected a bit, found a plate, which drills no hole");
  if (!(options.step_s > 0.0) || !(options.max_rest_s >= 0.0) || !std::isfinite(options.max_rest_s)) {
    fail("heat: expected a step above 0 and a rest of 0 or more, found ", options.step_s, " and ", options.max_rest_s,
         " s");
  }
  const BitProfile profile(bit);
  const double back_mm = wall_back_mm(bit);
  std::size_t n = 0;
  while (n < steps.size()) {
    progress.report("heat", static_cast<double>(n) / static_cast<double>(steps.size()));
    double dt_s = 0.0, heat_j = 0.0;
    Vec3 ring = Vec3::Zero();
    Vec3 axis = Vec3::Zero();
    Pose end;
    for (; n < steps.size() && dt_s < options.step_s; ++n) {
      const HeatStep& step = steps[n];
      if (!step.pose.tip_mm.allFinite() || !(std::abs(step.pose.axis.norm() - 1.0) < 0.01) || !(step.dt_s > 0.0)) {
        continue;  // the session did nothing with it either
      }
      const double step_j = step.bone_w * step.dt_s;
      end = {step.pose.tip_mm, step.pose.axis.normalized()};
      ring += step_j * (end.tip_mm - back_mm * end.axis);
      axis += step_j * end.axis;
      heat_j += step_j;
      dt_s += step.dt_s;
    }
    if (!(dt_s > 0.0)) break;
    grid.drill(profile, end);
    if (heat_j > 0.0) grid.heat_ring(ring / heat_j, axis.normalized(), bit.radius_mm(), heat_j);
    grid.advance(dt_s);
  }
  DrillingHeat result;
  const double hot_k = grid.hot_rise_k()[0];
  for (double rest_s = 0.0; rest_s < options.max_rest_s && grid.warmest_k() > hot_k; rest_s += 0.25) {
    progress.report("heat", 1.0);
    grid.advance(0.25);
  }
  result.has_cooled = !(grid.warmest_k() > hot_k);
  result.hottest = grid.hottest();
  result.hottest_at_half = grid.hottest(0.5);
  result.hot_60_s_mm3 = grid.hot_volume_mm3(0, 60.0);
  result.hot_30_s_mm3 = grid.hot_volume_mm3(1, 30.0);
  result.hot_0_mm3 = grid.hot_volume_mm3(0, 0.0);
  result.balance = grid.balance();
  result.time_s = grid.time_s();
  return result;
}

Mat3 axes_along(const Vec3& axis) {
  Mat3 axes;
  axes.col(0) = any_perpendicular(axis);
  axes.col(1) = axis.cross(axes.col(0));
  axes.col(2) = axis;
  return axes;
}

}  // namespace spinaltap
