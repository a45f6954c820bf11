#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "core/points/point_volume.h"
#include "core/session/choose_engine.h"
#include "core/tool/drill_path.h"

namespace spinaltap {

// The workloads by which engines are measured and compared: docs/drilling-benchmarks.md. All of them drill the paper's
// cylinder: radius 3.0 mm, length 37.8 mm, every point occupied.

/// How the bit moves from the entry to the target, in 37,800 cycles.
enum class WorkloadMotion {
  on_path,          ///< lock-step, 0.001 mm a cycle
  off_path,         ///< the same, parallel to the path at 1.2 mm
  tilted,           ///< the same, tilted by 3 degrees about the path's middle
  tremor,           ///< 1 mm/s at 1 kHz with a tremor of 0.1 mm (Tremor)
  tremor_off_path,  ///< the same, parallel to the path at 1.2 mm
  tilted_10,        ///< as `tilted`, by 10 degrees
  tilted_20,
  tilted_30,
  tilted_60,
  on_path_burr,         ///< as `on_path`, with a round burr
  tremor_burr,          ///< as `tremor`, with a round burr
  tremor_burr_off_path  ///< the same, parallel to the path at 1.2 mm
};

/// "on-path", "off-path", "tilted", "tremor", "tremor-off-path", "tilted-10", ..., "tremor-burr", ...
std::string_view name_of(WorkloadMotion motion);
std::span<const WorkloadMotion> workload_motions();
/// The first five, which the paper's own algorithms are measured on too.
bool is_of_paper(WorkloadMotion motion);
/// As a session would know it.
MotionClass workload_way(WorkloadMotion motion);

/// 37.8 mm, oblique to all axes and far from the origin, as in a patient. The bit is 50 mm long with a tip of 5 mm.
DrillPath workload_path(double diameter_mm);
/// That bit; or a ball of this diameter on a shank half as wide.
DrillBit workload_bit(WorkloadMotion motion, double diameter_mm);

/// The cylinder around the path: 986,958 points at a spacing of 0.1 mm, 8,029,476 at 0.05, 64,775,592 at 0.025. CT
/// numbers vary along the path: 300 HU and a sine of 100 HU every 5 mm. Throws Error as PointVolume does.
PointVolume workload_volume(double spacing_mm, HuBits hu_bits = HuBits::eight);

/// Makes every point occupied.
void restore_all(PointVolume& volume);

/// Poses 0 to 37,800, patient LPS: the first before cycle 0, the others after each cycle. `seed` is the operator's.
std::vector<Pose> workload_poses(WorkloadMotion motion, std::uint64_t seed = 1);

/// One long step, from a pose that the bit is put at to another.
struct StepWorkload {
  std::string_view name;
  DrillBit bit;
  Pose from;  ///< patient LPS
  Pose to;
};

/// A round burr, 6 mm with a shank of 3 mm, its ball half in the cylinder at the path's middle: 1 mm sideways, towards
/// the path.
StepWorkload burr_step();
/// The drill of 3.0 mm at the end of the path: 2.4 mm sideways.
StepWorkload sideways_step();

}  // namespace spinaltap
