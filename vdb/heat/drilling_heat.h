#pragma once

#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/heat/cutting_heat.h"
#include "core/heat/hole_heat.h"
#include "core/session/record/session_record.h"
#include "core/tool/drill_bit.h"
#include "vdb/heat/heat_grid.h"

namespace spinaltap {

/// A cycle of a drilling, as heat is concerned.
struct HeatStep {
  Pose pose;  ///< at its end, patient LPS
  double dt_s = 0.0;
  double bone_w = 0.0;  ///< given to the wall of the hole
};

/// Those of a recorded drilling at `rpm`: cutting_heat() of each cycle; none where the spindle is off.
std::vector<HeatStep> heat_steps(std::span<const RecordedCycle> cycles, const DrillBit& bit, double rpm,
                                 const ThermalBone& bone);

struct DrillingHeatOptions {
  double step_s = 0.02;       ///< cycles are taken together for so long
  double max_rest_s = 300.0;  ///< after the drilling, to see it cool down to HeatGridOptions::hot_rise_k[0]
};

/// What a drilling came to. Rises are of bone that is there at the end.
struct DrillingHeat {
  HottestVoxel hottest;          ///< at the wall, as far as voxels tell
  HottestVoxel hottest_at_half;  ///< 0.5 mm or more from the wall
  double hot_60_s_mm3 = 0.0;     ///< hotter than hot_rise_k[0] (47 °C) for 60 s
  double hot_30_s_mm3 = 0.0;     ///< hotter than hot_rise_k[1] (50 °C) for 30 s
  double hot_0_mm3 = 0.0;        ///< ever hotter than hot_rise_k[0]
  HeatBalance balance;
  double time_s = 0.0;  ///< drilling and rest
  bool has_cooled = false;
};

/// Drills the grid along the steps, heats the wall behind the bit's widest place, and waits until it is cool. Throws
/// Error on a plate, which has no hole, and on options that make no sense.
DrillingHeat run_drilling_heat(HeatGrid& grid, const DrillBit& bit, std::span<const HeatStep> steps,
                               const DrillingHeatOptions& options = {}, const Progress& progress = {});

/// Axes of a grid along a hole, in columns, the third along `axis` (unit).
Mat3 axes_along(const Vec3& axis);

}  // namespace spinaltap
