#include "core/session/operator/path_motion.h"

#include <cmath>
#include <numbers>

#include "core/base/error.h"
#include "core/base/random.h"

namespace spinaltap {

Tremor::Tremor(double amplitude_mm, std::uint64_t seed)
    : amplitude_mm_(amplitude_mm / std::sqrt(static_cast<double>(kSinusoids))) {
  constexpr double kMaxMm = 100.0;
  if (!(amplitude_mm >= 0.0 && amplitude_mm <= kMaxMm)) {
    fail("operator: expected a tremor of 0 to ", kMaxMm, " mm, found ", amplitude_mm, " mm");
  }
  std::uint64_t index = 0;
  for (auto& axis : phases_rad_) {
    for (double& phase : axis) phase = 2.0 * std::numbers::pi * random_uniform(seed, index++);
  }
  // One frequency to each fifth of the band, about its middle: no two make whole numbers of turns in the same time, and
  // none beats slowly with its neighbour.
  constexpr double kLowestHz = 8.0, kHighestHz = 12.0;
  for (auto& axis : frequencies_hz_) {
    for (std::size_t n = 0; n < axis.size(); ++n) {
      const double fifths = static_cast<double>(n) + 0.25 + 0.5 * random_uniform(seed, index++);
      axis[n] = kLowestHz + (kHighestHz - kLowestHz) * fifths / static_cast<double>(axis.size());
    }
  }
}

Vec3 Tremor::at_mm(double time_s) const {
  Vec3 sum = Vec3::Zero();
  for (std::size_t axis = 0; axis < phases_rad_.size(); ++axis) {
    for (std::size_t n = 0; n < kSinusoids; ++n) {
      sum[static_cast<Eigen::Index>(axis)] +=
          std::sin(2.0 * std::numbers::pi * frequencies_hz_[axis][n] * time_s + phases_rad_[axis][n]);
    }
  }
  return amplitude_mm_ * sum;
}

GuidedBit::GuidedBit(const DrillPath& path, const GuideLine& line)
    : curve_((check_path(path), path)), begin_mm_(-line.lead_in_mm), end_mm_(curve_.length_mm()) {
  if (!(line.lead_in_mm >= 0.0 && line.lead_in_mm <= 500.0)) {
    fail("operator: expected a lead-in of 0 to 500 mm, found ", line.lead_in_mm, " mm");
  }
  if (!(std::abs(line.offset_mm) <= 100.0) || !(std::abs(line.tilt_deg) <= 60.0)) {
    fail("operator: expected an offset within 100 mm and a tilt within 60 degrees, found ", line.offset_mm, " mm and ",
         line.tilt_deg, " degrees");
  }
  frame_ = PathFrame(path.entry_mm, path.direction());
  const double tilt = line.tilt_deg * std::numbers::pi / 180.0;
  axis_path_ = Vec3(std::sin(tilt), 0.0, std::cos(tilt));
  middle_path_ = Vec3(0.0, line.offset_mm, 0.5 * end_mm_);
  axis_ = tilt == 0.0 ? path.direction() : frame_.to_patient(Pose{Vec3::Zero(), axis_path_}).axis;
  const double aside_mm = std::hypot(line.offset_mm, std::sin(tilt) * (0.5 * end_mm_ + line.lead_in_mm));
  if (!(aside_mm < curve_.min_radius_mm())) {
    fail("operator: expected a line that stays nearer to the path than its tightest bend, of ", curve_.min_radius_mm(),
         " mm, found one ", aside_mm, " mm off it");
  }
}

Pose GuidedBit::at(double depth_mm, const Vec3& aside_mm) const {
  const Vec3 p_path = middle_path_ + (depth_mm - 0.5 * end_mm_) * axis_path_ + aside_mm;
  if (curve_.is_straight()) return {frame_.to_patient(p_path), axis_};
  return {curve_.to_patient(p_path), (curve_.axes_at(p_path.z()) * axis_path_).normalized()};
}

PathMotionOptions in_steps_of(double step_mm, const GuideLine& line) {
  if (!(step_mm > 0.0)) fail("operator: expected an advance above 0 mm a cycle, found ", step_mm, " mm");
  PathMotionOptions options;
  options.line = line;
  options.feed.steps = {{0.0, step_mm * options.rate_hz}};
  return options;
}

PathMotion::PathMotion(const DrillPath& path, const PathMotionOptions& options)
    : bit_(path, options.line),
      profile_(bit_.begin_mm(), bit_.end_mm(), options.feed),
      tremor_(options.tremor_mm, options.seed),
      trembles_(options.tremor_mm > 0.0),
      rate_hz_(options.rate_hz) {
  constexpr double kMaxCycles = 0x1.0p27;
  const double cycles = profile_.duration_s() * options.rate_hz;
  if (!(options.rate_hz > 0.0) || !(cycles <= kMaxCycles)) {
    fail("operator: expected a rate above 0 and at most ", kMaxCycles, " cycles, found ", options.rate_hz, " Hz and ",
         cycles, " cycles");
  }
  // The last cycle may be shorter than a step, so that the run ends at the target.
  cycles_ = static_cast<std::size_t>(std::ceil(cycles * (1.0 - 1e-12)));
}

Vec3 PathMotion::tremor_mm(std::size_t index) const {
  return trembles_ ? tremor_.at_mm(static_cast<double>(index) / rate_hz_) : Vec3::Zero();
}

Pose PathMotion::pose(std::size_t index) const { return bit_.at(depth_mm(index), tremor_mm(index)); }

}  // namespace spinaltap
