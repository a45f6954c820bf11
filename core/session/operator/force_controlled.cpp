#include "core/session/operator/force_controlled.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"

namespace spinaltap {
namespace {

void check_range(double value, double lowest, double highest, const char* what) {
  if (!(value >= lowest && value <= highest)) {
    fail("operator that pushes: expected ", what, " from ", lowest, " to ", highest, ", found ", value);
  }
}

}  // namespace

ForceControlled::ForceControlled(const DrillPath& path, const ForceControlOptions& options)
    : bit_(path, options.line),
      tremor_(options.tremor_mm, options.seed),
      options_(options),
      dt_s_(1.0 / options.rate_hz),
      depth_mm_(bit_.begin_mm()) {
  check_range(options.rate_hz, 1.0, 1e5, "a rate (Hz)");
  check_range(options.spindle.rpm, 1.0, 1e6, "a spindle's speed (turns a minute)");
  check_range(options.push_n, 0.0, 1e4, "a push (N)");
  check_range(options.ramp_s, 0.0, 60.0, "a ramp (s)");
  check_range(options.approach_mm_s, 1e-3, 1e3, "an approach (mm/s)");
  check_range(options.mass_kg, 1e-3, 1e3, "a mass (kg)");
  check_range(options.damping_n_s_mm, 0.0, 1e3, "a damping (N s/mm)");
  check_range(options.reaction_s, 0.0, 60.0, "a reaction time (s)");
  check_range(options.noticed_share, 0.0, 1.0, "a noticed share of the push");
  check_range(options.longest_s, dt_s_, 1e5, "a longest time (s)");
}

void ForceControlled::feel(const ToolFeedback& feedback) noexcept {
  // An order to stop is not undone while the operator reacts to it; that thrust is low may pass.
  if (feedback.stop || stop_s_ > 0.0) stop_s_ += dt_s_;
  const bool is_loose = phase_ == Phase::push && pushed_s_ > options_.ramp_s &&
                        counterforce_n_ < options_.noticed_share * options_.push_n;
  loose_s_ = is_loose ? loose_s_ + dt_s_ : 0.0;
  const FeedResistance& bone = feedback.force.resistance;
  if (phase_ == Phase::approach && (bone.lips_n > 0.0 || bone.chisel_n > 0.0)) phase_ = Phase::push;
  // Half a cycle forgives the rounding of sums of cycles.
  const double reaction_s = options_.reaction_s - 0.5 * dt_s_;
  const bool has_reacted = (stop_s_ > 0.0 && stop_s_ > reaction_s) || (is_loose && loose_s_ > reaction_s);
  // The target it sees coming.
  if (has_reacted || depth_mm_ >= bit_.end_mm()) phase_ = Phase::let_go;
}

void ForceControlled::move(const FeedResistance& bone) noexcept {
  if (phase_ == Phase::approach) {
    feed_mm_s_ = std::min(options_.approach_mm_s, (bit_.end_mm() - depth_mm_) / dt_s_);
    depth_mm_ += feed_mm_s_ * dt_s_;
    return;
  }
  double push_n = 0.0;
  if (phase_ == Phase::push) {
    pushed_s_ += dt_s_;
    push_n = pushed_s_ < options_.ramp_s ? options_.push_n * pushed_s_ / options_.ramp_s : options_.push_n;
  }
  const double mass_n_s_mm = 1e-3 * options_.mass_kg / dt_s_;  // N of one cycle's change of feed by 1 mm/s
  const double driving_n = push_n + mass_n_s_mm * feed_mm_s_;
  const double turns_per_s = options_.spindle.rpm / 60.0;
  const auto resisting_n = [&](double mm_s) {
    return (mass_n_s_mm + options_.damping_n_s_mm) * mm_s + bone.thrust_n(mm_s / turns_per_s);
  };
  double feed_mm_s = 0.0;
  // What does not overcome the chisel edge stands.
  if (driving_n > bone.chisel_n) {
    // The thrust rises with the feed: halving finds the one feed that fits, the same on every machine.
    constexpr int kHalvings = 44;
    double low_mm_s = 0.0;
    double high_mm_s = driving_n / (mass_n_s_mm + options_.damping_n_s_mm);
    for (int halving = 0; halving < kHalvings; ++halving) {
      const double middle_mm_s = 0.5 * (low_mm_s + high_mm_s);
      (resisting_n(middle_mm_s) < driving_n ? low_mm_s : high_mm_s) = middle_mm_s;
    }
    feed_mm_s = 0.5 * (low_mm_s + high_mm_s);
  }
  counterforce_n_ = driving_n - (mass_n_s_mm + options_.damping_n_s_mm) * feed_mm_s;
  feed_mm_s_ = feed_mm_s;
  depth_mm_ += feed_mm_s * dt_s_;
}

std::optional<ToolInput> ForceControlled::next(const ToolFeedback& feedback) {
  constexpr double kStandS = 0.3;  // how long it stands until it ends
  constexpr double kStillMmS = 0.01;
  if (cycle_ > 0) {
    feel(feedback);
    move(feedback.force.resistance);
    still_s_ = phase_ == Phase::let_go && feed_mm_s_ < kStillMmS ? still_s_ + dt_s_ : 0.0;
  }
  const double time_s = static_cast<double>(cycle_) * dt_s_;
  if (still_s_ > kStandS || time_s > options_.longest_s) return std::nullopt;
  ++cycle_;
  return ToolInput{bit_.at(depth_mm_, tremor_.at_mm(time_s)), true, dt_s_};
}

}  // namespace spinaltap
