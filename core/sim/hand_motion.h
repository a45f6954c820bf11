#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/drill/drill_path.h"
#include "core/drill/path_frame.h"

namespace spinaltap {

/// A hand that guides a bit along a path, as a haptic device reports it.
struct HandOptions {
  double feed_mm_s = 1.0;   ///< along the path
  double rate_hz = 1000.0;  ///< poses a second
  double offset_mm = 0.0;   ///< sideways shift from the path, as LockStepOptions has it
  double tremor_mm = 0.1;   ///< along each axis: the rms is that of one sinusoid of this amplitude
  std::uint64_t seed = 1;   ///< of the tremor's phases
};

/// Poses of a hand: even feed along the path, and a tremor of 8 to 12 Hz, the band of physiological tremor. The
/// tremor moves the tip along all three axes, each by a sum of five sinusoids of 8, 9, 10, 11 and
/// 12 Hz with seeded phases; the bit stays parallel to the path. Computed from the index alone: no error adds up.
class HandMotion {
 public:
  /// Throws Error on a bad path, on a feed or a rate that is not above 0, and on over 2^27 cycles.
  HandMotion(const DrillPath& path, const HandOptions& options);

  std::size_t cycle_count() const { return cycles_; }
  /// Patient LPS, mm. But for the tremor, index 0 is at the entry and cycle_count() at the target.
  Pose pose(std::size_t index) const;
  /// The tremor alone: the tip's displacement in path-local coordinates, mm.
  Vec3 tremor_mm(std::size_t index) const;

 private:
  static constexpr std::array<double, 5> kFrequenciesHz{8.0, 9.0, 10.0, 11.0, 12.0};

  PathFrame frame_;
  Vec3 axis_;
  double length_mm_;
  double offset_mm_;
  double advance_mm_;  ///< a cycle
  double rate_hz_;
  double amplitude_mm_;  ///< of one sinusoid
  std::array<std::array<double, kFrequenciesHz.size()>, 3> phases_rad_{};
  std::size_t cycles_ = 0;
};

}  // namespace spinaltap
