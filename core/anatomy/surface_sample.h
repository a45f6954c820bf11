#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/anatomy/bone_shape.h"
#include "core/base/geometry.h"

namespace spinaltap {

/// Thins points out: places of those that are the first in their cell, in the order in which they come. Cells are cubes
/// of `cell_mm`; one has its lowest corner at `origin_mm`. Throws Error on positions that are not finite, and where
/// the points lie in a box of over 2^32 cells.
std::vector<std::size_t> first_of_each_cell(std::span<const Vec3> points_mm, const Vec3& origin_mm, double cell_mm);

/// A bone's surface as few points: one for each cell of 1 mm that it crosses, the first of BoneShape's.
struct SurfaceSample {
  std::vector<Vec3> points_mm, normals;
  std::vector<double> areas_mm2;  ///< of the surface that each stands for, in the mean
};

SurfaceSample sample_surface(const BoneShape& bone);

}  // namespace spinaltap
