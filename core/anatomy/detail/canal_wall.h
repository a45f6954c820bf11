#pragma once

#include <cstdint>
#include <vector>

#include "core/anatomy/landmarks.h"
#include "core/anatomy/surface_sample.h"

namespace spinaltap {

/// The direction along which the canal's wall runs: at right angles to the wall's normals, as well as can be (least
/// squares with Tukey's biweight), within 10 mm of canal.centre_mm. `landmarks`: body, axes and a first canal.
Vec3 direction_of_canal(const BoneShape& bone, const SurfaceSample& surface, const Landmarks& landmarks);

/// Of each of bone.points_mm(): 1 where it is a wall of the canal. That is what the canal's axis sees of the bone
/// within the canal's width, from a little above the body to a little below: the back of the body, the inner sides of
/// the pedicles, the fronts of laminae. `landmarks`: all but the flags.
std::vector<std::uint8_t> canal_wall_flags(const BoneShape& bone, const Landmarks& landmarks);

/// Sizes and the middle of the canal at the level of `at_mm`, a place in it, with axes of the vertebra. Depth is the
/// least between the body and the laminae within 12 mm of that level; 0 where there are no laminae.
Landmarks::Canal measure_canal(const BoneShape& bone, const Vec3& at_mm, const Vec3& canal_axis, const Mat3& axes);

}  // namespace spinaltap
