#pragma once

#include <optional>

#include "core/ct/ct_volume.h"
#include "core/segment/float_grid.h"

namespace spinaltap {

/// Thresholds for bone with hysteresis: bone is what lies over `low_hu` and hangs together with something over
/// `sure_hu`.
struct BoneLevels {
  double noise_hu = 0.0;  ///< standard deviation in soft tissue
  double low_hu = 150.0;
  double sure_hu = 250.0;
  double blur_voxels = 0.0;  ///< standard deviation of the blur before thresholding that the noise asks for
};

/// Standard deviation of the noise (HU) in soft tissue: from the differences of neighbours between -200 and 300 HU, by
/// their median, which edges do not move. 0 when there are none.
double estimate_noise_hu(const CtVolume& ct);

/// Levels for a CT: low_hu is 150 HU in a quiet CT, down to 115 HU in a noisy one, whose blur lowers the thin cortex,
/// or `threshold_hu`. sure_hu lies a third of the way up to the cortex, the densest 5% of the voxels over low_hu.
/// Throws Error when no voxel is over low_hu, or the threshold is not a number.
BoneLevels choose_bone_levels(const CtVolume& ct, std::optional<double> threshold_hu = std::nullopt);

/// A part of the CT, binned or not, blurred as the noise asks for before thresholding: as it is in a quiet CT.
FloatGrid blurred_as_asked(FloatGrid hu, const BoneLevels& levels, const CtVolume& ct);

}  // namespace spinaltap
