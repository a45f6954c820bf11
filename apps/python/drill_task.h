#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/tool/drill_path.h"
#include "vdb/sim/session_batch.h"

namespace spinaltap {

/// How a learner drills a pedicle.
struct DrillTaskOptions {
  int cycles_a_step = 20;  ///< for which an action holds: 50 decisions a second
  double dt_s = 0.001;     ///< of a cycle
  int max_steps = 3000;    ///< then the episode is cut off

  // What an action of 1 means.
  double max_feed_mm_s = 3.0;
  double max_aside_mm_s = 2.0;
  double max_turn_deg_s = 5.0;

  // How an episode begins: so far before the entry, at random off the path and tilted by up to so much.
  double start_mm = 2.0;
  double start_offset_mm = 0.5;
  double start_tilt_deg = 3.0;

  // What it is worth. Each mm deeper than ever: 1.
  double margin_mm = 1.0;        ///< of clearance; less costs
  double margin_cost_s = 2.0;    ///< a second without any clearance
  double target_reward = 10.0;   ///< for the target
  double breach_penalty = 20.0;  ///< for a breach
  double radius_mm = 5.0;        ///< of the cylinder of points; who leaves it is cut off
  double spacing_mm = 0.2;       ///< between them
};
/// Throws Error on values that make no sense.
void check_drill_task(const DrillTaskOptions& options);

/// Drill a pedicle: to the path's target without a breach. Many at once, each the same to the last bit as if alone.
class DrillTask {
 public:
  /// Each from -1 to 1: feed along the bit's axis; aside along the path's own x and y; turn towards them.
  static constexpr std::size_t kActions = 5;
  /// In coordinates of the path: z along it, the entry at 0. Forces are what the operator feels.
  static constexpr std::array<std::string_view, 13> kObservations{
      "depth_mm",  "to_target_mm",       "aside_x_mm",        "aside_y_mm", "axis_x",
      "axis_y",    "force_x_n",          "force_y_n",         "force_z_n",  "torque_n_mm",
      "feed_mm_s", "clearance_outer_mm", "clearance_canal_mm"};
  static constexpr double kFarMm = 8.0;  ///< clearances are cut off there

  /// Throws Error as SessionBatch does.
  DrillTask(std::vector<BonePath> holes, std::size_t count, const DrillTaskOptions& options, int threads,
            const Progress& progress = {});

  std::size_t count() const { return episodes_.size(); }

  /// Begins a new episode of each, and gives their first observations, a row each. `seeds`: of what is random from here
  /// on; without one, the next episode of the last seed.
  void reset(std::span<const std::optional<std::uint64_t>> seeds, std::span<float> observations);

  /// What a step of all came to; a row each.
  struct Step {
    std::span<float> observations;
    std::span<double> rewards;
    std::span<bool> terminated;  ///< at the target, or by a breach
    std::span<bool> truncated;   ///< too many steps, or out of the points
    std::span<bool> breached;
    std::span<double> clearances_mm;     ///< least of the step
    std::span<double> thrusts_n;         ///< greatest of the step
    std::span<float> last_observations;  ///< of episodes that ended; empty: they do not begin again by themselves
  };
  /// `actions`: count() by kActions, cut off at -1 and 1. Throws Error where one is not a number, before anything
  /// moves.
  void step(std::span<const float> actions, const Step& to);

  /// From now on each step() leaves here what each drilling took of its thread's processor time, s: to tell what two
  /// threads bring on a machine that has other work. Stays where it is.
  std::span<const double> time_drillings();

 private:
  /// Lines of the cache are not shared: different threads write to neighbours.
  struct alignas(64) Episode {
    std::uint64_t seed = 0;
    std::uint64_t number = 0;
    int steps = 0;
    bool is_over = true;
    double deepest_mm = 0.0;
    double feed_mm_s = 0.0;
    PathFrame frame;
    double length_mm = 0.0;
    Pose pose;  ///< path-local
  };

  void begin(std::size_t n);
  void step_one(std::size_t n, std::span<const float> action, const Step& to);
  void observe(std::size_t n, std::span<float> observation);

  DrillTaskOptions options_;
  SessionBatch batch_;
  std::vector<Episode> episodes_;
  std::vector<double> cpu_s_;  ///< of each, where it is wanted
};

}  // namespace spinaltap
