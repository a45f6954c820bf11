#pragma once

#include <vector>

#include "core/plan/bone_shape.h"

namespace spinaltap {

/// A bone's surface as few points: one for each cell of 1 mm that it crosses, the first of BoneShape's.
struct SurfaceSample {
  std::vector<Vec3> points_mm, normals;
  std::vector<double> areas_mm2;  ///< of the surface that each stands for, in the mean
};

SurfaceSample sample_surface(const BoneShape& bone);

}  // namespace spinaltap
