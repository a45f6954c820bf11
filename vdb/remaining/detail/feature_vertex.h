#pragma once

#include <span>

#include "core/base/geometry.h"

namespace spinaltap::detail {

/// A point of a surface and its unit normal there, outward.
struct SurfacePlane {
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::Zero();
};

/// The point that lies nearest to all planes (least squares), moved from the planes' mean point only in directions that
/// the normals tell apart; not further than the box around 0 and 1. (Ju, Losasso, Schaefer & Warren 2002, "Dual
/// contouring of Hermite data"; Lindstrom 2000 for the directions.) At least one plane.
Vec3 feature_vertex(std::span<const SurfacePlane> planes);

}  // namespace spinaltap::detail
