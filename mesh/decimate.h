#pragma once

#include "core/base/progress.h"
#include "core/base/triangle_mesh.h"
#include "mesh/remesh.h"

namespace spinaltap {

/// The same surface in fewer triangles: edges collapse while every vertex of `mesh`, which must be closed and manifold,
/// stays within `max_error_mm` of the result. Creases stay sharp: a vertex on one goes along it or not at all.
///
/// Garland & Heckbert 1997, "Surface simplification using quadric error metrics", with Klein, Liebich & Strasser 1996's
/// bound of the distance. Changed: parts of the mesh are made coarser side by side, their borders afterwards; both
/// distances are measured then, mesh to surface at thirteen places of each triangle, and self-intersections looked for;
/// near the places that miss what was asked all vertices of `mesh` are kept and it is done again.
///
/// What could not be reached is said in the report, in which `surface` is `mesh` and `rounds` counts attempts; angles
/// are not looked after. The same input gives the same bits at any number of threads. Throws Error on an error that is
/// not above 0 mm, and when `mesh` is empty, not closed or not manifold.
TriangleMesh decimate(const TriangleMesh& mesh, double max_error_mm, RemeshReport* report = nullptr,
                      const Progress& progress = {});

}  // namespace spinaltap
