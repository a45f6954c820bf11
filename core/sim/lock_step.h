#pragma once

#include <cstdint>
#include <vector>

#include "core/base/progress.h"
#include "core/drill/drill_engine.h"

namespace spinaltap {

/// A bit that advances along a straight line, by itself parallel to the path or tilted to it.
struct LockStepOptions {
  double step_mm = 0.001;  ///< advance a cycle
  double offset_mm = 0.0;  ///< sideways shift of the bit's line from the path
  double tilt_deg = 0.0;   ///< between the bit's line and the path; they meet (or pass) at the path's middle
};

/// One cycle of a lock-step run.
struct CycleRecord {
  double depth_mm = 0.0;        ///< of the tip beyond the entry, along the path
  std::uint32_t removed = 0;    ///< points
  std::uint32_t tested = 0;     ///< points
  std::int64_t removed_hu = 0;  ///< sum over the removed points
  float work_n_mm = 0.0F;
  float thrust_n = 0.0F;
  std::uint32_t wall_ns = 0;  ///< time of the engine's step, saturated at 4.29 s
};

/// Poses of a lock-step run: computed from the index alone, so that no error adds up.
class LockStepMotion {
 public:
  /// From the volume's start to the path's target. Throws Error on steps that are not above 0 or over 2^27 cycles.
  LockStepMotion(const DrillPath& path, double lead_in_mm, const LockStepOptions& options);

  std::size_t cycle_count() const { return cycles_; }
  /// Patient LPS, mm. Index 0 is the start, before the first cycle; cycle_count() is the end.
  Pose pose(std::size_t index) const;
  /// Depth of the tip beyond the entry, along the bit's line, mm.
  double depth_mm(std::size_t index) const;

 private:
  Vec3 start_mm_;
  Vec3 axis_;
  double length_mm_;
  double lead_in_mm_;
  double step_mm_;
  std::size_t cycles_;
};

/// Moves the bit one step, lets the engine run one cycle, and so on to the end (the paper's section 9.3).
std::vector<CycleRecord> run_lock_step(DrillEngine& engine, const LockStepMotion& motion,
                                       const Progress& progress = {});

}  // namespace spinaltap
