#include "core/session/operator/force_controlled.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/check_range.h"

namespace spinaltap {
namespace {

void check_push(double value, double lowest, double highest, const char* what) {
  check_range(value, lowest, highest, "operator that pushes", what);
}

}  // namespace

ForceControlled::ForceControlled(const DrillPath& path, const ForceControlOptions& options)
    : bit_(path, options.line),
      tremor_(options.tremor_mm, options.seed),
      options_(options),
      dt_s_(1.0 / options.rate_hz),
      depth_mm_(bit_.begin_mm()),
      push_n_(options.push_n) {
  check_push(options.rate_hz, 1.0, 1e5, "a rate (Hz)");
  check_push(options.spindle.rpm, 1.0, 1e6, "a spindle's speed (turns a minute)");
  check_push(options.push_n, 0.0, 1e4, "a push (N)");
  check_push(options.ramp_s, 0.0, 60.0, "a ramp (s)");
  check_push(options.approach_mm_s, 1e-3, 1e3, "an approach (mm/s)");
  check_push(options.mass_kg, 1e-3, 1e3, "a mass (kg)");
  check_push(options.damping_n_s_mm, 0.0, 1e3, "a damping (N s/mm)");
  check_push(options.reaction_s, 0.0, 60.0, "a reaction time (s)");
  check_push(options.noticed_share, 0.0, 1.0, "a noticed share of the push");
  check_push(options.max_push_n, 0.0, 1e4, "a push where it stands (N)");
  check_push(options.raise_n_s, 0.0, 1e4, "a rise of the push (N/s)");
  check_push(options.rock_deg, 0.0, 20.0, "a rocking (degrees)");
  check_push(options.careful_mm_s, 1e-3, 1e3, "a careful feed (mm/s)");
  check_push(options.stands_s, 0.0, 1e5, "a time to stand (s)");
  check_push(options.longest_s, dt_s_, 1e5, "a longest time (s)");
  options_.max_push_n = std::max(options.max_push_n, options.push_n);
}

void ForceControlled::feel(const ToolFeedback& feedback) noexcept {
  // An order to stop is not undone while the operator reacts to it; that thrust is low may pass.
  if (feedback.stop || stop_s_ > 0.0) stop_s_ += dt_s_;
  const CuttingResistance& bone = feedback.force.resistance;
  if (phase_ == Phase::approach && (bone.lips_n > 0.0 || bone.chisel_n > 0.0)) phase_ = Phase::push;
  // Half a cycle forgives the rounding of sums of cycles.
  const double reaction_s = options_.reaction_s - 0.5 * dt_s_;
  const bool is_loose = gives_way();
  loose_s_ = is_loose ? loose_s_ + dt_s_ : 0.0;
  has_noticed_ = has_noticed_ || (is_loose && loose_s_ > reaction_s);
  const bool is_asked = stop_s_ > 0.0 && stop_s_ > reaction_s;
  // The target it sees coming.
  if (is_asked || has_noticed_ || depth_mm_ >= bit_.end_mm()) phase_ = Phase::let_go;
}

/// Whether the counterforce is as small as at a breakthrough. A careful operator goes by what it was, if that could be
/// felt: it holds the bit back, and does not push into soft bone with all of its force.
bool ForceControlled::gives_way() noexcept {
  constexpr double kFeltN = 5.0;   // of the hand, above what it holds the drill with
  constexpr double kFadesS = 2.0;  // what was felt is forgotten so fast
  felt_n_ = std::max(counterforce_n_, felt_n_ * (1.0 - dt_s_ / kFadesS));
  if (phase_ != Phase::push || pushed_s_ <= options_.ramp_s) return false;
  if (!is_careful_) return counterforce_n_ < options_.noticed_share * push_n_;
  return felt_n_ > kFeltN && counterforce_n_ < options_.noticed_share * felt_n_;
}

/// Pushes harder, and rocks, where the bit stands or crawls.
void ForceControlled::lean() noexcept {
  constexpr double kSlowMmS = 0.3;
  constexpr double kStandsMmS = 0.02;
  constexpr double kNoticedS = 1.0;
  constexpr double kRockRisesS = 0.3;
  const bool pushes = phase_ == Phase::push && pushed_s_ > options_.ramp_s;
  slow_s_ = pushes && feed_mm_s_ < kSlowMmS ? slow_s_ + dt_s_ : 0.0;
  const bool leans = slow_s_ > kNoticedS;
  if (leans) push_n_ = std::min(options_.max_push_n, push_n_ + options_.raise_n_s * dt_s_);
  const bool stands = pushes && feed_mm_s_ < kStandsMmS && push_n_ >= options_.max_push_n;
  stands_s_ = stands ? stands_s_ + dt_s_ : 0.0;
  rock_ += ((leans ? 1.0 : 0.0) - rock_) * dt_s_ / (kRockRisesS + dt_s_);
  rocked_s_ += dt_s_;
}

void ForceControlled::move(const CuttingResistance& bone) noexcept {
  if (phase_ == Phase::approach) {
    feed_mm_s_ = std::min(options_.approach_mm_s, (bit_.end_mm() - depth_mm_) / dt_s_);
    depth_mm_ += feed_mm_s_ * dt_s_;
    return;
  }
  double push_n = 0.0;
  if (phase_ == Phase::push) {
    pushed_s_ += dt_s_;
    push_n = pushed_s_ < options_.ramp_s ? push_n_ * pushed_s_ / options_.ramp_s : push_n_;
  }
  // Who leans on a drill braces the arm as well: freed, it goes no faster than one that was pushed.
  const double braced_n_s_mm = options_.damping_n_s_mm * std::max(1.0, push_n_ / std::max(options_.push_n, 1.0));
  const double damping_n_s_mm = is_careful_ ? std::max(braced_n_s_mm, push_n_ / options_.careful_mm_s) : braced_n_s_mm;
  const double mass_n_s_mm = 1e-3 * options_.mass_kg / dt_s_;  // N of one cycle's change of feed by 1 mm/s
  const double driving_n = push_n + mass_n_s_mm * feed_mm_s_;
  const double turns_per_s = options_.spindle.rpm / 60.0;
  const auto resisting_n = [&](double mm_s) {
    return (mass_n_s_mm + damping_n_s_mm) * mm_s + bone.thrust_n(mm_s / turns_per_s);
  };
  double feed_mm_s = 0.0;
  // What does not overcome the chisel edge stands.
  if (driving_n > bone.chisel_n) {
    // The thrust rises with the feed: halving finds the one feed that fits, the same on every machine.
    constexpr int kHalvings = 44;
    double low_mm_s = 0.0;
    double high_mm_s = driving_n / (mass_n_s_mm + damping_n_s_mm);
    for (int halving = 0; halving < kHalvings; ++halving) {
      const double middle_mm_s = 0.5 * (low_mm_s + high_mm_s);
      (resisting_n(middle_mm_s) < driving_n ? low_mm_s : high_mm_s) = middle_mm_s;
    }
    feed_mm_s = 0.5 * (low_mm_s + high_mm_s);
  }
  counterforce_n_ = driving_n - (mass_n_s_mm + damping_n_s_mm) * feed_mm_s;
  feed_mm_s_ = feed_mm_s;
  depth_mm_ += feed_mm_s * dt_s_;
}

/// Also looks after what it does once it stands.
bool ForceControlled::is_over(const ToolFeedback& feedback) noexcept {
  constexpr double kStandS = 0.3;  // how long it stands until it ends, or goes on
  constexpr double kStillMmS = 0.01;
  if (phase_ == Phase::push) {
    if (!(stands_s_ > options_.stands_s)) return false;
    end_ = OperatorEnd::stood_still;
    return true;
  }
  if (phase_ != Phase::let_go) return false;
  still_s_ = feed_mm_s_ < kStillMmS ? still_s_ + dt_s_ : 0.0;
  if (!(still_s_ > kStandS)) return false;
  if (stop_s_ > 0.0 || depth_mm_ >= bit_.end_mm()) return true;
  if (!feedback.has_floor) {
    end_ = OperatorEnd::broke_through;
    return true;
  }
  phase_ = Phase::push;
  is_careful_ = true;
  has_noticed_ = false;
  push_n_ = options_.push_n;
  pushed_s_ = still_s_ = slow_s_ = stands_s_ = loose_s_ = felt_n_ = 0.0;
  return false;
}

Pose ForceControlled::pose(double time_s) const {
  Pose straight = bit_.at(depth_mm_, tremor_.at_mm(time_s));
  if (!(rock_ > 1e-6)) return straight;
  constexpr double kRocksHz = 1.5;
  const double turn = rock_ * options_.rock_deg * kDegree * std::sin(2.0 * std::numbers::pi * kRocksHz * rocked_s_);
  const Vec3 pivot_mm = bit_.at(std::min(depth_mm_, 0.0)).tip_mm;
  const Vec3 about = any_perpendicular(straight.axis);
  const Mat3 turned = Eigen::AngleAxisd(turn, about).toRotationMatrix();
  return {pivot_mm + turned * (straight.tip_mm - pivot_mm), (turned * straight.axis).normalized(), straight.side};
}

std::optional<ToolInput> ForceControlled::next(const ToolFeedback& feedback) {
  if (cycle_ > 0) {
    feel(feedback);
    move(feedback.force.resistance);
    lean();
    if (is_over(feedback)) return std::nullopt;
  }
  const double time_s = static_cast<double>(cycle_) * dt_s_;
  if (time_s > options_.longest_s) {
    if (depth_mm_ < bit_.end_mm()) end_ = OperatorEnd::ran_out_of_time;
    return std::nullopt;
  }
  ++cycle_;
  return ToolInput{pose(time_s), true, dt_s_};
}

}  // namespace spinaltap
