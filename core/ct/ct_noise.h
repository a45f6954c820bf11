#pragma once

#include <optional>

#include "core/ct/ct_volume.h"

namespace spinaltap {

/// Standard deviation of a CT's noise (HU) in homogeneous soft tissue: of what a plane leaves in squares of 8 mm of a
/// slice whose voxels are all between -200 and 300 HU, exceeded by two thirds of these squares, since most hold more
/// than one tissue. Unlike differences of neighbours, it does not take the noise for less where the scanner's kernel
/// blurs it. Nothing where there is no such square.
std::optional<double> ct_noise_hu(const CtVolume& ct);

}  // namespace spinaltap
