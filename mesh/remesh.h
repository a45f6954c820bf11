#pragma once

#include <cstddef>

#include "core/base/progress.h"
#include "core/base/scalar_field.h"
#include "core/base/triangle_mesh.h"
#include "mesh/mesh_distance.h"

namespace spinaltap {

struct RemeshOptions {
  double max_error_mm = 0.05;        ///< between mesh and surface, both ways
  double smallest_angle_deg = 15.0;  ///< of every triangle, at most 25
  double shortest_edge_mm = 0.1;     ///< wanted where the surface is most curved; rims sharper than this miss the error
  double longest_edge_mm = 5.0;      ///< wanted where it is flat
};

struct RemeshReport {
  std::size_t rounds = 0;     ///< how often the mesh was made finer where it missed what was asked
  MeshDistance to_surface;    ///< how far the mesh lies from the surface, sampled as mesh_to_surface() does
  MeshDistance from_surface;  ///< how far the start's vertices, drawn onto the surface, lie from the mesh
  double smallest_angle_deg = 0.0;
  std::size_t self_intersections = 0;
  bool reached = false;  ///< error, angles and no self-intersection
};

/// A mesh for display and print of the surface that `start` follows: triangles as large as the error allows, small
/// where the surface is curved, near to equilateral everywhere. The topology is that of `start`, whose vertices must
/// lie near `surface`'s zero set (about as near as its edges are long).
///
/// Botsch & Kobbelt 2004, "A remeshing approach to multiresolution modeling", with edge lengths after Dunyach et al.
/// 2013, "Adaptive remeshing for real-time mesh deformation". Changed: triangles are kept from turning against the
/// surface's normals; vertices go to the zero set itself, by Newton's method; thin triangles get a stage of their own;
/// where error, angle or self-intersection are not what was asked, edges are made shorter and it is done again.
///
/// What could not be reached (`report->reached` false) is said in the report. Single-threaded but for evaluations of
/// `surface`; the same input gives the same bits. Throws Error on bad options and when `start` is empty, not closed or
/// not manifold.
TriangleMesh remesh(const TriangleMesh& start, const ScalarField& surface, const RemeshOptions& options = {},
                    RemeshReport* report = nullptr, const Progress& progress = {});

}  // namespace spinaltap
