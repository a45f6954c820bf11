#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/anatomy/bone_shape.h"
#include "core/ct/hu_to_density.h"

namespace spinaltap {

/// Further than this from 0, the tri-linear lattice of a BoneShape has the distance's sign: its own error is below
/// 0.44 mm, the mean way to the corners of a cell at most.
inline constexpr double kSureLatticeMm = 0.5;

/// 1 where a place is in the bone. As BoneShape::is_inside() of each, but the surface is asked only where the lattice
/// leaves a warning.
std::vector<std::uint8_t> inside_bone(const BoneShape& bone, std::span<const Vec3> points_mm);

/// CT numbers at places, HU; NaN outside the bone, of which `hu` is not asked.
std::vector<float> hu_inside_bone(const BoneShape& bone, const HuSampler& hu, std::span<const Vec3> points_mm);

}  // namespace spinaltap
