#include "core/session/operator/tremor.h"

#include <cmath>
#include <numbers>

#include "core/base/error.h"
#include "core/base/random.h"

namespace spinaltap {

Tremor::Tremor(double amplitude_mm, std::uint64_t seed)
    : amplitude_mm_(amplitude_mm / std::sqrt(static_cast<double>(kFrequenciesHz.size()))) {
  constexpr double kMostMm = 100.0;
  if (!(amplitude_mm >= 0.0 && amplitude_mm <= kMostMm)) {
    fail("hand: expected a tremor of 0 to ", kMostMm, " mm, found ", amplitude_mm, " mm");
  }
  std::uint64_t index = 0;
  for (auto& axis : phases_rad_) {
    for (double& phase : axis) phase = 2.0 * std::numbers::pi * random_uniform(seed, index++);
  }
}

Vec3 Tremor::at_mm(double time_s) const {
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
