#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/engine/drill_engine.h"
#include "core/session/real_time/timing.h"

namespace spinaltap {

using EngineFactory =
    std::function<std::unique_ptr<DrillEngine>(PointVolume& volume, const DrillBit& bit, const Material& material)>;

/// What a measured engine is put to: a bit and its way. The volume is made occupied again for every run.
struct EngineRun {
  EngineFactory make_engine;
  DrillBit bit;
  std::span<const Pose> poses;  ///< patient LPS; the first is where the bit is put, each other one ends a cycle
};

/// An engine on bone of any kind, and its way.
struct WayRun {
  std::function<std::unique_ptr<DrillEngine>()> begin;  ///< makes all bone occupied and a new engine for it
  std::function<std::size_t()> bone_bytes;
  std::function<std::uint64_t()> occupancy_hash;
  std::span<const Pose> poses;  ///< as EngineRun has them
};

/// Cycles in a row, timed together: each clock read once before and once after them.
struct Stretch {
  std::size_t begin = 0;  ///< first cycle
  std::size_t end = 0;    ///< one past the last
  std::int64_t cpu_ns = 0;
  std::int64_t wall_ns = 0;
  std::size_t removed = 0;  ///< points
  std::size_t tested = 0;   ///< points
  double removed_mm3 = 0.0;

  /// Of the calling thread's CPU time.
  double cycles_per_cpu_s() const;
  double cycles_per_wall_s() const;
  void add(const Stretch& next);
};

struct EngineMeasurement {
  std::size_t path_cycles = 0;  ///< from the path's start to its end
  bool is_whole_path = true;    ///< else: windows of the path
  Stretch first_tenth;          ///< or the window in its middle, and so on
  Stretch middle_tenth;
  Stretch last_tenth;
  std::vector<Stretch> curve;        ///< along the path
  Stretch all;                       ///< sums over all that was timed
  std::size_t cycles = 0;            ///< that the spreads are of
  TimeSpread cpu;                    ///< of single cycles, of the calling thread
  TimeSpread wall;                   ///< of single cycles, from a run of their own
  std::size_t memory_bytes = 0;      ///< volume and engine
  std::uint64_t occupancy_hash = 0;  ///< of the points occupied at the end of the path; 0 for windows
};

/// Goes the whole way three times: once timed in hundredths of the path, once with each cycle's wall time, once with
/// each cycle's CPU time. No clock is read within the stretches of the first, and the reading's own time is taken off.
EngineMeasurement measure_way(const WayRun& run, const ClockCosts& costs, const Progress& progress = {},
                              const std::string& stage = "measuring");

/// The same of points.
EngineMeasurement measure_whole_path(const EngineRun& run, PointVolume& volume, const ClockCosts& costs,
                                     const Progress& progress = {}, const std::string& stage = "measuring");

struct WindowOptions {
  std::size_t cycles = 200;       ///< of a window
  double max_window_cpu_s = 1.0;  ///< a window ends early, though not before its fifth cycle
  bool finer_curve = false;       ///< also timed at the borders between tenths
};

/// For slow engines: measures windows in the middle of each tenth of the path and of the whole path, three times each
/// as above. The volume is brought there with the ring engine; the measured engine takes one step at the window's first
/// pose, then those that are timed. Throws Error when it leaves other points occupied than the ring engine does.
EngineMeasurement measure_windows(const EngineRun& run, PointVolume& volume, const ClockCosts& costs,
                                  const WindowOptions& options, const Progress& progress = {},
                                  const std::string& stage = "measuring");

/// A long step, from the first of two poses to the second.
struct StepMeasurement {
  std::int64_t wall_ns = 0;
  std::int64_t cpu_ns = 0;  ///< of all threads
  std::size_t removed = 0;  ///< points, by the step alone
  std::size_t tested = 0;
  std::uint64_t occupancy_hash = 0;
};

/// Takes the step once, with every point occupied and a new engine.
StepMeasurement measure_step(const EngineRun& run, PointVolume& volume);

}  // namespace spinaltap
