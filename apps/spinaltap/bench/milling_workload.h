#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "apps/spinaltap/bench/measure_engine.h"
#include "vdb/grid/bone_model.h"
#include "vdb/sim/drilled_bone.h"

namespace spinaltap {

/// A ball burr in a hand that trembles mills the phantom's L3 from its upper endplate: lines of 14 mm, 1 mm apart, in
/// layers of 1 mm, at 50 mm/s with a tremor of 0.1 mm (Tremor).
struct MillingWorkload {
  double diameter_mm = 4.0;  ///< of the ball, on a shank half as wide and 60 mm long
  double tilt_deg = 0.0;     ///< from straight down, in the plane of the lines
  double step_mm = 0.05;     ///< a cycle, but for what the hand trembles: 1 kHz
  double spacing_mm = 0.1;   ///< of voxels or points
  bool has_forces = false;   ///< the cycle works out what the operator feels, too
  double lever_mm = 0.0;     ///< above 0: it turns instead about a place so far behind its tip, see turning_poses()
};

/// The phantom's L3. Baking takes seconds: 0.25 mm eight times as long.
BoneModel milling_bone(double voxel_mm = 0.5);
/// In the middle of its upper endplate, patient LPS, mm.
Vec3 milling_start_mm();
DrillBit milling_burr(double diameter_mm);
/// A burr that swings from -5 to 5 degrees and back, a degree a cycle, and goes 0.1 mm aside after each of 120 swings.
/// Patient LPS.
std::vector<Pose> turning_poses(double lever_mm);
/// Patient LPS: the first before cycle 0, the others after each cycle. `seed`: of the tremor. All of turning_poses()
/// where there is a lever.
std::vector<Pose> milling_poses(const MillingWorkload& workload, std::size_t cycles, std::uint64_t seed = 1);

/// Voxels of the whole bone; or points of a cylinder of 20 mm that holds what a burr of up to 6 mm reaches in
/// kMillingCycles steps of 0.05 mm at tilts of up to kMaxPointTiltDeg.
DrilledBone milled_bone(const BoneModel& bone, EngineKind engine, double spacing_mm);
inline constexpr std::size_t kMillingCycles = 30'000;
inline constexpr double kMaxPointTiltDeg = 30.0;

/// Runs the workload on a bone, all of which lives in `whole`, on one thread; both must outlive what it gives, and so
/// must the poses. Steps of voxels are not shared out.
WayRun milling_run(DrilledBone& bone, const DrilledBone& whole, const MillingWorkload& workload,
                   std::span<const Pose> poses);

}  // namespace spinaltap
