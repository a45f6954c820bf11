#pragma once

#include <functional>
#include <span>

#include "core/ct/hu_to_density.h"
#include "core/plan/bone_shape.h"

namespace spinaltap {

/// CT numbers (HU) at positions (patient LPS, mm).
using HuSampler = std::function<void(std::span<const Vec3>, std::span<float>)>;

/// Densities (g/cm³) at positions (patient LPS, mm); 0 where there is no bone.
using DensitySampler = std::function<void(std::span<const Vec3>, std::span<double>)>;

/// A bone's density by its CT numbers: 0 outside its surface and where there is no CT number. Refers to `bone`, which
/// must outlive it.
DensitySampler bone_density(const BoneShape& bone, HuSampler hu, const HuToDensity& calibration);

}  // namespace spinaltap
