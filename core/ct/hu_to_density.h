#pragma once

#include <functional>
#include <span>

#include "core/base/geometry.h"

namespace spinaltap {

/// Bone's density from its CT number: a line, never below 0. The numbers and their sources are in data/densities/.
struct HuToDensity {
  double at_0_hu = 0.05;    ///< g/cm³
  double per_hu = 0.00105;  ///< g/cm³ per HU

  /// Density, g/cm³.
  double density_g_cm3(double hu) const;
};

/// Rejects values that are not finite or absurd, and calibrations by which bone of a higher CT number would be no
/// denser.
void check_hu_to_density(const HuToDensity& line);

/// A rod of known density in a calibration phantom, and its mean CT number.
struct CalibrationPair {
  double hu = 0.0;
  double density_g_cm3 = 0.0;
};

/// A line and where it is from.
struct DensityCalibration {
  HuToDensity line;
  double rms_residual_g_cm3 = 0.0;  ///< root mean square of what the pairs miss the line by
  double max_residual_g_cm3 = 0.0;  ///< the largest of it
};

/// The line of least squares (in density) through measured pairs, in the order of the pairs. Throws Error where fewer
/// than two CT numbers differ, where a number is not finite, and where the line does not rise.
DensityCalibration calibrate_density(std::span<const CalibrationPair> pairs);

/// CT numbers (HU) at positions (patient LPS, mm).
using HuSampler = std::function<void(std::span<const Vec3>, std::span<float>)>;

/// Densities (g/cm³) at positions (patient LPS, mm); 0 where there is no bone.
using DensitySampler = std::function<void(std::span<const Vec3>, std::span<double>)>;

}  // namespace spinaltap
