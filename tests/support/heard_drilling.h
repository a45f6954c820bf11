#pragma once

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <vector>

#include "core/sound/breakthrough_listener.h"
#include "core/sound/session_sound.h"
#include "tests/support/pedicle_drilling.h"
#include "tests/support/random_vertebra.h"

namespace spinaltap::test {

struct HeardDrilling {
  double through_s = std::nan("");  ///< when the tip was at the end of the phantom's bone
  std::vector<HeardBreakthrough> heard;

  // A point of bone is 0.1 mm from the next, which the feed of 1 mm/s takes 0.1 s for: so much earlier it may be gone.
  static constexpr double kEarlyS = 0.1;
  static constexpr double kLateS = 0.14;
  bool is_right(const HeardBreakthrough& one) const {
    return one.time_s >= through_s - kEarlyS && one.time_s <= through_s + kLateS;
  }
  /// How late it was heard; not a number: it was not.
  double late_s() const {
    for (const HeardBreakthrough& one : heard) {
      if (is_right(one)) return one.time_s - through_s;
    }
    return std::nan("");
  }
  /// What was heard elsewhere, or again.
  std::size_t false_alarms() const { return heard.size() - (std::isnan(late_s()) ? 0 : 1); }
};

struct HeardConditions {
  DrillBit bit = twist_drill(3.0, 70.0, 118.0, 0.48);
  double feed_mm_s = 1.0;
  double rate_hz = 100.0;
  double rpm = 1250.0;
  std::uint64_t sound_seed = 1;
};

/// A session through a pedicle of a vertebra and on through the front of its body, 100 cycles a second. The bone is the
/// phantom's own formula, without any CT, and so is the truth of where it ends.
struct PedicleSession {
  SessionSetup setup;
  double end_mm = 0.0;  ///< of the bone, on the bit's axis
  std::vector<PointVolume> volumes;
  std::unique_ptr<DrillSession> session;
  PathMotionOptions motion;

  PedicleSession(const VertebraAnatomy& anatomy, bool is_left, const HeardConditions& conditions = {}) {
    const Vertebra vertebra(anatomy);
    const VertebraGroundTruth ground_truth = vertebra_ground_truth(vertebra);
    setup.path = path_through(is_left ? ground_truth.left : ground_truth.right, conditions.bit);
    setup.options.spindle.rpm = conditions.rpm;
    end_mm = true_boundaries(vertebra, setup.path).end_mm;
    const BoneSampler bone = [&](std::span<const Vec3> points_mm, std::span<float> distance_mm, std::span<float> hu) {
      std::vector<double> exact_mm(points_mm.size());
      vertebra.evaluate(points_mm, exact_mm, {});
      for (std::size_t n = 0; n < points_mm.size(); ++n) {
        distance_mm[n] = static_cast<float>(exact_mm[n]);
        hu[n] = static_cast<float>(vertebra.hu(points_mm[n], exact_mm[n], 0.0));
      }
    };
    volumes.emplace_back(setup.path, PointVolumeOptions{.radius_mm = 2.0, .spacing_mm = 0.1, .lead_in_mm = 3.0});
    fill_volume(volumes.front(), bone);
    session = std::make_unique<DrillSession>(setup.path, volumes,
                                             make_ring_engine(volumes.front(), setup.path.bit, setup.material),
                                             setup.material, nullptr, setup.options);
    motion.line.lead_in_mm = 3.0;
    motion.rate_hz = conditions.rate_hz;
    motion.feed.steps = {{0.0, conditions.feed_mm_s}};
  }
  void run(const CycleObserver& observe) {
    PlannedMotion tool_operator(setup.path, motion);
    run_session(*session, tool_operator, observe);
  }
};

/// Drills a pedicle of the random vertebra of this seed and hears it. What the listener gets is samples, nothing else.
inline HeardDrilling hear_pedicle(std::uint64_t seed, bool is_left, const HeardConditions& conditions = {}) {
  PedicleSession pedicle(random_anatomy(seed), is_left, conditions);
  DrillSoundOptions how = SessionSound::without_edges();
  how.seed = conditions.sound_seed;
  SessionSound sound(pedicle.setup, how);
  BreakthroughListener listener;
  HeardDrilling drilling;
  std::vector<float> samples;
  pedicle.run([&](const Cycle& cycle) {
    samples.clear();
    sound.add(cycle, samples);
    listener.hear(samples);
    if (std::isnan(drilling.through_s) && cycle.depth_mm >= pedicle.end_mm) drilling.through_s = cycle.time_s;
  });
  drilling.heard.assign(listener.heard().begin(), listener.heard().end());
  return drilling;
}

/// Of many drillings.
struct HeardFigures {
  std::size_t drillings = 0, found = 0, false_alarms = 0;
  double earliest_s = 0.0, latest_s = 0.0, sum_s = 0.0;

  void add(const HeardDrilling& drilling) {
    ++drillings;
    false_alarms += drilling.false_alarms();
    const double late_s = drilling.late_s();
    if (std::isnan(late_s)) return;
    earliest_s = found == 0 ? late_s : std::min(earliest_s, late_s);
    latest_s = found == 0 ? late_s : std::max(latest_s, late_s);
    sum_s += late_s;
    ++found;
  }
  void print(const char* what) const {
    std::printf("%s: heard %zu of %zu, %zu false alarms, %.0f to %.0f ms late, mean %.0f\n", what, found, drillings,
                false_alarms, 1e3 * earliest_s, 1e3 * latest_s, 1e3 * sum_s / static_cast<double>(found));
  }
};

}  // namespace spinaltap::test
