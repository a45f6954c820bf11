#pragma once

#include <functional>
#include <span>

#include "core/anatomy/bone_shape.h"
#include "core/ct/hu_to_density.h"

namespace spinaltap {

/// A bone's density by its CT numbers: 0 outside its surface and where there is no CT number. Refers to `bone`, which
/// must outlive it.
DensitySampler bone_density(const BoneShape& bone, HuSampler hu, const HuToDensity& calibration);

}  // namespace spinaltap
