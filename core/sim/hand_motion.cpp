#include "core/sim/hand_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/error.h"
#include "core/base/random.h"

namespace spinaltap {

HandMotion::HandMotion(const DrillPath& path, const HandOptions& options)
    : length_mm_(path.length_mm()),
      offset_mm_(options.offset_mm),
      advance_mm_(options.feed_mm_s / options.rate_hz),
      rate_hz_(options.rate_hz),
      amplitude_mm_(options.tremor_mm / std::sqrt(static_cast<double>(kFrequenciesHz.size()))) {
  constexpr double kMaxCycles = 0x1.0p27;
  check_path(path);
  if (!(options.feed_mm_s > 0.0) || !(options.rate_hz > 0.0) || !(length_mm_ / advance_mm_ <= kMaxCycles)) {
    fail("hand: expected a feed and a rate above 0 and at most ", kMaxCycles, " cycles, found ", options.feed_mm_s,
         " mm/s and ", options.rate_hz, " Hz");
  }
  if (!(std::abs(options.offset_mm) <= 100.0) || !(options.tremor_mm >= 0.0) || !(options.tremor_mm <= 100.0)) {
    fail("hand: expected an offset within 100 mm and a tremor of 0 to 100 mm, found ", options.offset_mm, " mm and ",
         options.tremor_mm, " mm");
  }
  frame_ = PathFrame(path.entry_mm, path.direction());
  axis_ = path.direction();
  std::uint64_t index = 0;
  for (auto& axis : phases_rad_) {
    for (double& phase : axis) phase = 2.0 * std::numbers::pi * random_uniform(options.seed, index++);
  }
  cycles_ = static_cast<std::size_t>(std::ceil(length_mm_ / advance_mm_ * (1.0 - 1e-12)));
}

Pose HandMotion::pose(std::size_t index) const {
  const double depth_mm = std::min(static_cast<double>(index) * advance_mm_, length_mm_);
  return {frame_.to_patient(Vec3(Vec3(0.0, offset_mm_, depth_mm) + tremor_mm(index))), axis_};
}

Vec3 HandMotion::tremor_mm(std::size_t index) const {
  const double time_s = static_cast<double>(index) / rate_hz_;
  Vec3 sum = Vec3::Zero();
  for (std::size_t axis = 0; axis < phases_rad_.size(); ++axis) {
    for (std::size_t n = 0; n < kFrequenciesHz.size(); ++n) {
      sum[static_cast<Eigen::Index>(axis)] +=
          std::sin(2.0 * std::numbers::pi * kFrequenciesHz[n] * time_s + phases_rad_[axis][n]);
    }
  }
  return amplitude_mm_ * sum;
}

}  // namespace spinaltap
