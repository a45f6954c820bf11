#include "apps/spinaltap/bench/measure_engine.h"

#include <algorithm>
#include <limits>

#include "apps/spinaltap/bench/drill_workload.h"
#include "core/base/error.h"
#include "core/base/hash.h"

namespace spinaltap {
namespace {

constexpr std::size_t kHundred = 100;

std::uint64_t hash_of(const PointVolume& volume) {
  WordHash64 hash;
  hash.add(volume.occupancy_words().data(), volume.occupancy_words().size_bytes());
  return hash.value();
}

void check_poses(std::span<const Pose> poses) {
  if (poses.size() <= kHundred) {
    fail("measuring: expected more than ", kHundred, " cycles, found ", poses.size(), " poses");
  }
}

/// Steps the engine through cycles begin to end and times them together. Ends early after `max_ns` of CPU time.
Stretch time_together(DrillEngine& engine, std::span<const Pose> poses, std::size_t begin, std::size_t end,
                      const ClockCosts& costs, std::int64_t max_ns = std::numeric_limits<std::int64_t>::max()) {
  constexpr std::size_t kMinCycles = 5;
  Stretch stretch{.begin = begin, .end = end};
  const bool is_limited = max_ns < std::numeric_limits<std::int64_t>::max();
  const std::int64_t wall_start = wall_ns();
  const std::int64_t cpu_start = thread_cpu_ns();
  for (std::size_t cycle = begin; cycle < end; ++cycle) {
    const StepResult result = engine.step(poses[cycle + 1]);
    stretch.removed += result.removed;
    stretch.tested += result.tested;
    stretch.removed_mm3 += result.removed_mm3;
    if (is_limited && cycle + 1 - begin >= kMinCycles && thread_cpu_ns() - cpu_start > max_ns) {
      stretch.end = cycle + 1;
      break;
    }
  }
  stretch.cpu_ns = std::max<std::int64_t>(1, thread_cpu_ns() - cpu_start - costs.cpu_ns);
  stretch.wall_ns = std::max<std::int64_t>(1, wall_ns() - wall_start - costs.wall_ns - 2 * costs.cpu_ns);
  return stretch;
}

/// Steps the engine through cycles begin to end and times each.
template <class Clock>
void time_each(DrillEngine& engine, std::span<const Pose> poses, std::size_t begin, std::size_t end, const Clock& clock,
               std::int64_t cost_ns, std::vector<std::int64_t>& samples_ns) {
  for (std::size_t cycle = begin; cycle < end; ++cycle) {
    const std::int64_t start = clock();
    engine.step(poses[cycle + 1]);
    const std::int64_t elapsed = clock() - start;
    samples_ns.push_back(std::max<std::int64_t>(0, elapsed - cost_ns));
  }
}

/// A new engine at a pose.
std::unique_ptr<DrillEngine> placed(const EngineFactory& make_engine, PointVolume& volume, const DrillBit& bit,
                                    const Pose& pose) {
  std::unique_ptr<DrillEngine> engine = make_engine(volume, bit, Material());
  engine->step(pose);
  return engine;
}

Stretch stretch_of(const std::vector<Stretch>& stretches, std::size_t begin, std::size_t end) {
  Stretch sum = stretches[begin];
  for (std::size_t n = begin + 1; n < end; ++n) sum.add(stretches[n]);
  return sum;
}

/// Which points are occupied, to be put back.
class OccupiedPoints {
 public:
  explicit OccupiedPoints(const PointVolume& volume)
      : words_(volume.occupancy_words().begin(), volume.occupancy_words().end()),
        words_per_disc_(volume.occupancy_words(0).size()) {}

  void put_back(PointVolume& volume) const {
    for (int disc = 0; disc < volume.disc_count(); ++disc) {
      const auto begin = words_.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(disc) * words_per_disc_);
      std::copy_n(begin, words_per_disc_, volume.occupancy_words(disc).begin());
    }
  }
  bool are_those_of(const PointVolume& volume) const { return std::ranges::equal(words_, volume.occupancy_words()); }

 private:
  std::vector<std::uint64_t> words_;
  std::size_t words_per_disc_;
};

}  // namespace

double Stretch::cycles_per_cpu_s() const {
  return 1e9 * static_cast<double>(end - begin) / static_cast<double>(cpu_ns);
}

double Stretch::cycles_per_wall_s() const {
  return 1e9 * static_cast<double>(end - begin) / static_cast<double>(wall_ns);
}

void Stretch::add(const Stretch& next) {
  end += next.end - next.begin;
  cpu_ns += next.cpu_ns;
  wall_ns += next.wall_ns;
  removed += next.removed;
  tested += next.tested;
  removed_mm3 += next.removed_mm3;
}

EngineMeasurement measure_way(const WayRun& run, const ClockCosts& costs, const Progress& progress,
                              const std::string& stage) {
  check_poses(run.poses);
  const std::size_t cycles = run.poses.size() - 1;
  const auto border = [&](std::size_t hundredth) { return hundredth * cycles / kHundred; };
  ProgressCounter counter(progress, stage, 3 * kHundred);
  const auto drill = [&](const auto& measure) {
    const auto engine = run.begin();
    engine->step(run.poses[0]);
    for (std::size_t n = 0; n < kHundred; ++n) {
      measure(*engine, border(n), border(n + 1));
      counter.add();
    }
    return run.bone_bytes() + engine->memory_bytes();
  };

  EngineMeasurement result;
  result.path_cycles = result.cycles = cycles;
  result.memory_bytes = drill([&](DrillEngine& engine, std::size_t begin, std::size_t end) {
    result.curve.push_back(time_together(engine, run.poses, begin, end, costs));
  });
  result.occupancy_hash = run.occupancy_hash();
  result.first_tenth = stretch_of(result.curve, 0, 10);
  result.middle_tenth = stretch_of(result.curve, 45, 55);
  result.last_tenth = stretch_of(result.curve, 90, 100);
  result.all = stretch_of(result.curve, 0, kHundred);

  std::vector<std::int64_t> samples_ns;
  samples_ns.reserve(cycles);
  drill([&](DrillEngine& engine, std::size_t begin, std::size_t end) {
    time_each(engine, run.poses, begin, end, wall_ns, costs.wall_ns, samples_ns);
  });
  result.wall = spread_of(samples_ns);
  samples_ns.clear();
  drill([&](DrillEngine& engine, std::size_t begin, std::size_t end) {
    time_each(engine, run.poses, begin, end, thread_cpu_ns, costs.cpu_ns, samples_ns);
  });
  result.cpu = spread_of(samples_ns);
  if (run.occupancy_hash() != result.occupancy_hash) fail("measuring: a repeated run left other points occupied");
  return result;
}

EngineMeasurement measure_whole_path(const EngineRun& run, PointVolume& volume, const ClockCosts& costs,
                                     const Progress& progress, const std::string& stage) {
  const auto begin = [&] {
    restore_all(volume);
    return run.make_engine(volume, run.bit, Material());
  };
  return measure_way({begin, [&] { return volume.memory_bytes(); }, [&] { return hash_of(volume); }, run.poses}, costs,
                     progress, stage);
}

EngineMeasurement measure_windows(const EngineRun& run, PointVolume& volume, const ClockCosts& costs,
                                  const WindowOptions& options, const Progress& progress, const std::string& stage) {
  // Windows lie around twentieths of the path: odd ones are the middles of tenths, the tenth is the path's middle.
  constexpr std::size_t kTwentieths = 20;
  check_poses(run.poses);
  const std::size_t cycles = run.poses.size() - 1;
  if (options.cycles < 1 || options.cycles > cycles / kTwentieths) {
    fail("measuring: expected windows of 1 to ", cycles / kTwentieths, " cycles, found ", options.cycles);
  }
  ProgressCounter counter(progress, stage, kTwentieths + 1);
  const auto max_ns = static_cast<std::int64_t>(1e9 * options.max_window_cpu_s);
  restore_all(volume);
  PointVolume pilot_volume = volume;
  std::size_t at = 0;
  const auto pilot = placed(make_ring_engine, pilot_volume, run.bit, run.poses[0]);
  const auto bring_to = [&](std::size_t index) {
    while (at < index) pilot->step(run.poses[++at]);
  };

  EngineMeasurement result;
  result.is_whole_path = false;
  result.path_cycles = cycles;
  std::vector<std::int64_t> wall_samples_ns;
  std::vector<std::int64_t> cpu_samples_ns;
  for (std::size_t place = 0; place <= kTwentieths; ++place) {
    counter.add();
    const bool is_timed = place % 2 == 1 || place == kTwentieths / 2;
    if (!is_timed && !options.finer_curve) continue;
    const std::size_t middle = place * cycles / kTwentieths;
    const std::size_t begin = std::min(middle - std::min(middle, options.cycles / 2), cycles - options.cycles);
    bring_to(begin);
    const OccupiedPoints before(pilot_volume);
    const auto at_begin = [&] {
      before.put_back(volume);
      return placed(run.make_engine, volume, run.bit, run.poses[begin]);
    };
    const auto engine = at_begin();
    const Stretch window = time_together(*engine, run.poses, begin, begin + options.cycles, costs, max_ns);
    result.memory_bytes = volume.memory_bytes() + engine->memory_bytes();
    bring_to(window.end);
    if (!OccupiedPoints(volume).are_those_of(pilot_volume)) {
      fail(stage, ": expected the points that the ring engine leaves occupied after cycle ", window.end,
           ", found others");
    }
    result.curve.push_back(window);
    if (!is_timed) continue;
    if (result.cycles == 0) result.first_tenth = result.all = window;
    if (result.cycles != 0) result.all.add(window);
    if (place == kTwentieths / 2) result.middle_tenth = window;
    result.last_tenth = window;
    result.cycles += window.end - window.begin;
    time_each(*at_begin(), run.poses, begin, window.end, wall_ns, costs.wall_ns, wall_samples_ns);
    time_each(*at_begin(), run.poses, begin, window.end, thread_cpu_ns, costs.cpu_ns, cpu_samples_ns);
  }
  result.wall = spread_of(wall_samples_ns);
  result.cpu = spread_of(cpu_samples_ns);
  return result;
}

StepMeasurement measure_step(const EngineRun& run, PointVolume& volume) {
  if (run.poses.size() != 2) fail("measuring: expected the two poses of a step, found ", run.poses.size());
  restore_all(volume);
  const auto engine = placed(run.make_engine, volume, run.bit, run.poses[0]);
  const std::int64_t wall_start = wall_ns();
  const std::int64_t cpu_start = process_cpu_ns();
  const StepResult step = engine->step(run.poses[1]);
  StepMeasurement result{.removed = step.removed, .tested = step.tested};
  result.cpu_ns = process_cpu_ns() - cpu_start;
  result.wall_ns = wall_ns() - wall_start;
  result.occupancy_hash = hash_of(volume);
  return result;
}

}  // namespace spinaltap
