#include "apps/python/drill_task.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/error.h"
#include "core/base/random.h"
#include "core/session/real_time/timing.h"
#include "core/tool/plate.h"

namespace spinaltap {

namespace {

constexpr double kMaxTiltDeg = 30.0;
constexpr std::uint64_t kDrawsAnEpisode = 4;

SessionSetup setup_of(const DrillTaskOptions& options) {
  check_drill_task(options);
  SessionSetup setup;
  setup.volume.radius_mm = options.radius_mm;
  setup.volume.spacing_mm = options.spacing_mm;
  setup.volume.lead_in_mm = std::max(3.0, options.start_mm);
  return setup;
}

std::vector<BonePath> of_tools_that_turn(std::vector<BonePath> holes) {
  for (const BonePath& hole : holes) check_turns(hole.path.bit, "a task of drilling");
  return holes;
}

/// Even on a disc of radius 1, from two draws.
Eigen::Vector2d on_disc(std::uint64_t seed, std::uint64_t index) {
  const double radius = std::sqrt(random_uniform(seed, index));
  const double angle = 2.0 * std::numbers::pi * random_uniform(seed, index + 1);
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

/// Of a direction as the frame has it; that of a place would be shifted.
Vec3 direction_in(const PathFrame& frame, const Vec3& v) { return frame.to_path(Pose{Vec3::Zero(), v}).axis; }

/// Tilted no further than bits can be told apart from what drills sideways.
Vec3 limited(const Vec3& axis) {
  Vec3 unit = axis.normalized();
  const double sine = std::hypot(unit.x(), unit.y());
  const double limit = std::sin(kMaxTiltDeg * kDegree);
  if (sine <= limit && unit.z() > 0.0) return unit;
  return {unit.x() * limit / sine, unit.y() * limit / sine, std::cos(kMaxTiltDeg * kDegree)};
}

double min_clearance_mm(const Clearance& clearance) { return std::min(clearance.outer_mm, clearance.canal_mm); }

}  // namespace

void check_drill_task(const DrillTaskOptions& options) {
  const auto check = [](double value, double min, const char* what) {
    if (!(value >= min && value < 1e6)) fail("drill task: expected ", what, " of ", min, " or more, found ", value);
  };
  check(options.cycles_a_step, 1, "cycles_per_step");
  check(options.dt_s, 1e-6, "dt_s");
  check(options.max_steps, 1, "max_steps");
  check(options.max_feed_mm_s, 0.0, "max_feed_mm_s");
  check(options.max_aside_mm_s, 0.0, "max_aside_mm_s");
  check(options.max_turn_deg_s, 0.0, "max_turn_deg_s");
  check(options.start_mm, 0.0, "start_mm");
  check(options.start_offset_mm, 0.0, "start_offset_mm");
  check(options.start_tilt_deg, 0.0, "start_tilt_deg");
  check(options.margin_mm, 1e-3, "margin_mm");
  check(options.margin_cost_s, 0.0, "margin_cost");
  check(options.target_reward, 0.0, "target_reward");
  check(options.breach_penalty, 0.0, "breach_penalty");
  if (options.start_tilt_deg > kMaxTiltDeg) {
    fail("drill task: expected start_tilt_deg of ", kMaxTiltDeg, " at most, found ", options.start_tilt_deg);
  }
}

DrillTask::DrillTask(std::vector<BonePath> holes, std::size_t count, const DrillTaskOptions& options, int threads,
                     const Progress& progress)
    : options_(options),
      batch_(of_tools_that_turn(std::move(holes)), count, setup_of(options), threads, progress),
      episodes_(count) {
  for (std::size_t n = 0; n < count; ++n) {
    const DrillPath& path = batch_.session(n).path();
    check_straight(path, "a task of drilling");
    episodes_[n].frame = PathFrame(path.entry_mm, path.direction());
    episodes_[n].length_mm = path.length_mm();
    episodes_[n].seed = n;
  }
}

void DrillTask::begin(std::size_t n) {
  Episode& episode = episodes_[n];
  DrillSession& session = batch_.reset(n);
  const std::uint64_t first = kDrawsAnEpisode * episode.number++;
  const Eigen::Vector2d offset_mm = options_.start_offset_mm * on_disc(episode.seed, first);
  const Eigen::Vector2d tilt = std::tan(options_.start_tilt_deg * kDegree) * on_disc(episode.seed, first + 2);
  episode.pose = {Vec3(offset_mm.x(), offset_mm.y(), -options_.start_mm), Vec3(tilt.x(), tilt.y(), 1.0).normalized()};
  episode.steps = 0;
  episode.is_over = false;
  episode.feed_mm_s = 0.0;
  episode.deepest_mm = episode.pose.tip_mm.z();
  session.step({episode.frame.to_patient(episode.pose), true, options_.dt_s});
}

void DrillTask::reset(std::span<const std::optional<std::uint64_t>> seeds, std::span<float> observations) {
  if (seeds.size() != count()) {
    fail("drill task: expected a seed for each of ", count(), " drillings, found ", seeds.size());
  }
  batch_.for_each([&](std::size_t n) {
    if (seeds[n]) {
      episodes_[n].seed = *seeds[n];
      episodes_[n].number = 0;
    }
    begin(n);
    observe(n, observations.subspan(n * kObservations.size(), kObservations.size()));
  });
}

std::span<const double> DrillTask::time_drillings() {
  cpu_s_.resize(count());
  return cpu_s_;
}

void DrillTask::observe(std::size_t n, std::span<float> observation) {
  const Episode& episode = episodes_[n];
  const Cycle& cycle = batch_.session(n).last();
  const Vec3 force_n = direction_in(episode.frame, cycle.force.force_n);
  const auto near_mm = [](double clearance_mm) { return std::clamp(clearance_mm, -kFarMm, kFarMm); };
  const Vec3& tip_mm = episode.pose.tip_mm;
  const std::array<double, kObservations.size()> values{tip_mm.z(),
                                                        episode.length_mm - tip_mm.z(),
                                                        tip_mm.x(),
                                                        tip_mm.y(),
                                                        episode.pose.axis.x(),
                                                        episode.pose.axis.y(),
                                                        force_n.x(),
                                                        force_n.y(),
                                                        force_n.z(),
                                                        cycle.force.torque_n_mm,
                                                        episode.feed_mm_s,
                                                        near_mm(cycle.clearance.outer_mm),
                                                        near_mm(cycle.clearance.canal_mm)};
  std::ranges::transform(values, observation.begin(), [](double value) { return static_cast<float>(value); });
}

void DrillTask::step(std::span<const float> actions, const Step& to) {
  for (const float action : actions) {
    if (std::isnan(action)) fail("drill task: expected actions from -1 to 1, found one that is not a number");
  }
  for (const Episode& episode : episodes_) {
    if (episode.is_over) fail("drill task: expected reset() before the first step of an episode");
  }
  batch_.for_each([&](std::size_t n) {
    const std::int64_t begun_ns = cpu_s_.empty() ? 0 : thread_cpu_ns();
    step_one(n, actions.subspan(n * kActions, kActions), to);
    if (!cpu_s_.empty()) cpu_s_[n] = 1e-9 * static_cast<double>(thread_cpu_ns() - begun_ns);
  });
}

void DrillTask::step_one(std::size_t n, std::span<const float> action, const Step& to) {
  Episode& episode = episodes_[n];
  DrillSession& session = batch_.session(n);
  const auto scaled = [&](std::size_t k, double max) {
    return std::clamp(static_cast<double>(action[k]), -1.0, 1.0) * max;
  };
  episode.feed_mm_s = scaled(0, options_.max_feed_mm_s);
  const Vec3 aside_mm =
      options_.dt_s * Vec3(scaled(1, options_.max_aside_mm_s), scaled(2, options_.max_aside_mm_s), 0.0);
  const double turn = options_.max_turn_deg_s * kDegree;
  const Vec3 turned = options_.dt_s * Vec3(scaled(3, turn), scaled(4, turn), 0.0);

  double cost = 0.0;
  double clearance_mm = std::numeric_limits<double>::infinity();
  double thrust_n = 0.0;
  const double deepest_before_mm = episode.deepest_mm;
  bool is_there = false;
  for (int cycle = 0; cycle < options_.cycles_a_step && !is_there && !(clearance_mm < 0.0); ++cycle) {
    episode.pose.axis = limited(episode.pose.axis + turned);
    episode.pose.tip_mm += options_.dt_s * episode.feed_mm_s * episode.pose.axis + aside_mm;
    const Cycle& done = session.step({episode.frame.to_patient(episode.pose), true, options_.dt_s});
    const double its_clearance_mm = min_clearance_mm(done.clearance);
    clearance_mm = std::min(clearance_mm, its_clearance_mm);
    thrust_n = std::max(thrust_n, done.force.thrust_n);
    episode.deepest_mm = std::clamp(episode.pose.tip_mm.z(), episode.deepest_mm, episode.length_mm);
    is_there = episode.pose.tip_mm.z() >= episode.length_mm;
    cost += options_.dt_s * options_.margin_cost_s *
            std::clamp((options_.margin_mm - its_clearance_mm) / options_.margin_mm, 0.0, 1.0);
  }
  const bool is_breach = clearance_mm < 0.0;
  const Vec3& tip_mm = episode.pose.tip_mm;
  const bool is_lost = std::hypot(tip_mm.x(), tip_mm.y()) > options_.radius_mm || tip_mm.z() < -3.0 * kFarMm;
  ++episode.steps;

  to.rewards[n] = episode.deepest_mm - deepest_before_mm - cost;
  if (is_breach) {
    to.rewards[n] -= options_.breach_penalty;
  } else if (is_there) {
    to.rewards[n] += options_.target_reward;
  }
  to.breached[n] = is_breach;
  to.terminated[n] = is_breach || is_there;
  to.truncated[n] = !to.terminated[n] && (is_lost || episode.steps >= options_.max_steps);
  to.clearances_mm[n] = clearance_mm;
  to.thrusts_n[n] = thrust_n;
  episode.is_over = to.terminated[n] || to.truncated[n];

  constexpr std::size_t kWidth = kObservations.size();
  const std::span<float> observation = to.observations.subspan(n * kWidth, kWidth);
  observe(n, observation);
  if (to.last_observations.empty()) return;
  std::ranges::copy(observation, to.last_observations.subspan(n * kWidth, kWidth).begin());
  if (!episode.is_over) return;
  begin(n);
  observe(n, observation);
}

}  // namespace spinaltap
