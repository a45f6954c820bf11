#pragma once

#include "core/base/progress.h"
#include "core/base/triangle_mesh.h"
#include "mesh/remesh.h"

namespace spinaltap {

/// The same surface in fewer triangles: edges collapse while every vertex of `mesh`, which must be closed and manifold,
/// stays within `max_error_mm` of the result. Creases stay sharp: a vertex on one goes along it or not at all. Angles
/// stay above 7 degrees and thin triangles of `mesh` are done away with as far as that allows; vertices move a little
/// for it, and where nothing else helps, a crease goes.
///
/// Garland & Heckbert 1997, "Surface simplification using quadric error metrics", with Klein, Liebich & Strasser 1996's
/// bound of the distance. Changed: a collapse is looked at when it is its turn, not whenever a triangle near it
/// changed; parts of the mesh are made coarser side by side, their borders afterwards; then thirteen places of each
/// triangle are looked at, and self-intersections; near what misses vertices of `mesh` are asked to stay within half of
/// what they were, in the end all to be kept, and it is done again.
///
/// What could not be reached is said in the report, in which `surface` is `mesh` and `rounds` counts attempts; its
/// distances are measured for it alone, and its smallest angle is what came out. The same input gives the same bits at
/// any number of threads. Throws Error on an error that is not above 0 mm, and when `mesh` is empty, not closed or not
/// manifold.
TriangleMesh decimate(const TriangleMesh& mesh, double max_error_mm, RemeshReport* report = nullptr,
                      const Progress& progress = {});

}  // namespace spinaltap
