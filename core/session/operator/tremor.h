#pragma once

#include <array>
#include <cstdint>

#include "core/base/geometry.h"

namespace spinaltap {

/// A hand's tremor: 8 to 12 Hz, the band of physiological tremor. Along each of three axes the sum of five sinusoids of
/// 8, 9, 10, 11 and 12 Hz with seeded phases. Computed from the time alone: no error adds up.
class Tremor {
 public:
  /// `amplitude_mm`: along each axis the rms is that of one sinusoid of this amplitude. Throws Error where it is not
  /// from 0 to 100 mm.
  Tremor(double amplitude_mm, std::uint64_t seed);

  /// The tip's displacement in path-local coordinates, mm.
  Vec3 at_mm(double time_s) const;

 private:
  static constexpr std::array<double, 5> kFrequenciesHz{8.0, 9.0, 10.0, 11.0, 12.0};

  double amplitude_mm_;  ///< of one sinusoid
  std::array<std::array<double, kFrequenciesHz.size()>, 3> phases_rad_{};
};

}  // namespace spinaltap
