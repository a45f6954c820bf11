#include "core/sim/lock_step.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/error.h"

namespace spinaltap {

LockStepMotion::LockStepMotion(const DrillPath& path, double lead_in_mm, const LockStepOptions& options)
    : length_mm_(path.length_mm() + lead_in_mm), lead_in_mm_(lead_in_mm), step_mm_(options.step_mm), cycles_(0) {
  constexpr double kMaxCycles = 0x1.0p27;
  check_path(path);
  if (!(lead_in_mm >= 0.0)) fail("drilling: expected a lead-in of 0 mm or more, found ", lead_in_mm, " mm");
  if (!(options.step_mm > 0.0) || !(length_mm_ / options.step_mm <= kMaxCycles)) {
    fail("drilling: expected an advance of ", length_mm_ / kMaxCycles, " mm a cycle or more, found ", options.step_mm);
  }
  if (!(std::abs(options.offset_mm) <= 100.0) || !(std::abs(options.tilt_deg) <= 60.0)) {
    fail("drilling: expected an offset within 100 mm and a tilt within 60 degrees, found ", options.offset_mm,
         " mm and ", options.tilt_deg, " degrees");
  }
  const PathFrame frame(path.entry_mm, path.direction());
  const double tilt = options.tilt_deg * std::numbers::pi / 180.0;
  const Vec3 axis_path(std::sin(tilt), 0.0, std::cos(tilt));
  const Vec3 middle_path(0.0, options.offset_mm, 0.5 * path.length_mm());
  axis_ = frame.to_patient(Pose{Vec3::Zero(), axis_path}).axis;
  const Vec3 start_path = middle_path - (lead_in_mm + 0.5 * path.length_mm()) * axis_path;
  start_mm_ = frame.to_patient(start_path);
  // The last cycle may be shorter than a step, so that the run ends at the target.
  cycles_ = static_cast<std::size_t>(std::ceil(length_mm_ / step_mm_ * (1.0 - 1e-12)));
}

Pose LockStepMotion::pose(std::size_t index) const {
  return {start_mm_ + std::min(static_cast<double>(index) * step_mm_, length_mm_) * axis_, axis_};
}

double LockStepMotion::depth_mm(std::size_t index) const {
  return std::min(static_cast<double>(index) * step_mm_, length_mm_) - lead_in_mm_;
}

std::vector<CycleRecord> run_lock_step(DrillEngine& engine, const LockStepMotion& motion, const Progress& progress) {
  using Clock = std::chrono::steady_clock;
  std::vector<CycleRecord> records(motion.cycle_count());
  ProgressCounter counter(progress, "drilling", records.size());
  engine.step(motion.pose(0));
  for (std::size_t cycle = 0; cycle < records.size(); ++cycle) {
    const Pose pose = motion.pose(cycle + 1);
    const Clock::time_point start = Clock::now();
    const StepResult result = engine.step(pose);
    const std::chrono::nanoseconds elapsed = Clock::now() - start;
    CycleRecord& record = records[cycle];
    record.depth_mm = motion.depth_mm(cycle + 1);
    record.removed = static_cast<std::uint32_t>(result.removed);
    record.tested = static_cast<std::uint32_t>(result.tested);
    record.removed_hu = result.removed_hu;
    record.work_n_mm = static_cast<float>(result.work_n_mm);
    record.thrust_n = static_cast<float>(result.thrust_n);
    record.wall_ns =
        static_cast<std::uint32_t>(std::min<std::int64_t>(elapsed.count(), std::numeric_limits<std::uint32_t>::max()));
    counter.add();
  }
  return records;
}

}  // namespace spinaltap
