#pragma once

#include <optional>

#include "core/base/progress.h"
#include "core/ct/ct_volume.h"

namespace spinaltap {

struct ThresholdOptions {
  /// Bone is at least this dense; by default what choose_threshold_hu() gives.
  std::optional<double> threshold_hu = std::nullopt;
  /// Width (standard deviation, in voxels) of the blur before thresholding; negative: chosen from the CT's noise.
  double smooth_voxels = -1.0;
  /// Gaps in the cortex narrower than twice this do not let marrow out; 0: 1 mm or twice the largest voxel step,
  /// whichever is larger.
  double seal_mm = 0.0;
};

/// The largest connected part of the voxels over a threshold, with its marrow: everything that a ball of radius
/// `seal_mm` cannot reach from outside without touching the bone. Throws Error when no voxel is over the threshold,
/// and on a blur over 10 voxels or a seal over 50 mm.
BoneMask threshold_mask(const CtVolume& ct, const ThresholdOptions& options = {}, const Progress& progress = {});

/// A threshold for bone: 150 HU in a quiet CT, down to 115 HU in a noisy one, whose blur lowers the thin cortex.
double choose_threshold_hu(const CtVolume& ct);

/// Standard deviation of the noise (HU) in soft tissue: from the differences of neighbours between -200 and 300 HU, by
/// their median, which edges do not move. 0 when there are none.
double estimate_noise_hu(const CtVolume& ct);

}  // namespace spinaltap
