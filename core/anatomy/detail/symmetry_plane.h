#pragma once

#include "core/anatomy/surface_sample.h"

namespace spinaltap {

struct SymmetryPlane {
  Vec3 point_mm = Vec3::Zero();
  Vec3 normal = Vec3::UnitX();  ///< unit, to the side to which that of the start points
  double residual_mm = 0.0;     ///< median distance between the surface and its mirror image
};

/// The plane that mirrors a bone's surface best onto itself, near a start: within 20 degrees about `superior` and
/// `posterior` and 6 mm to the sides. Parts without a counterpart, as a cut process or an asymmetric joint, do not pull
/// it.
///
/// First a search over a grid of planes with distances from a map of 1 mm voxels, then iterated closest points with
/// distances to tangent planes (Chen & Medioni 1992), in which the surface's points are matched with their own mirror
/// image, weighted by Tukey's biweight.
SymmetryPlane find_symmetry_plane(const BoneShape& bone, const SurfaceSample& surface, const SymmetryPlane& start,
                                  const Vec3& posterior, const Vec3& superior);

}  // namespace spinaltap
