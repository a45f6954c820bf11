#pragma once

#include "core/base/triangle_mesh.h"

namespace spinaltap {

/// How rough a surface is: the spread of its normals within a ball around each vertex, degrees, averaged over vertices
/// by the area around them. The spread is the root mean square angle between the normals and their mean, on the part of
/// the surface in the ball that faces the same way as the vertex. A surface with radius of curvature R has about
/// 57 * radius_mm / (1.4 R) of it without being rough, so compare with that of the truth.
/// Throws Error on an empty mesh, and on a radius that is not above 0.
double roughness_deg(const TriangleMesh& mesh, double radius_mm = 1.0);

}  // namespace spinaltap
