#pragma once

#include <cstddef>

#include "core/base/triangle_mesh.h"

namespace spinaltap {

/// Figures of a triangle mesh.
struct MeshQuality {
  std::size_t vertices = 0;
  std::size_t triangles = 0;
  std::size_t pieces = 0;          ///< connected parts
  std::size_t boundary_edges = 0;  ///< edges with one triangle; 0 when closed
  std::size_t rejected_faces = 0;  ///< triangles that would make an edge or vertex non-manifold, or are degenerate
  long euler_number = 0;           ///< used vertices - edges + triangles; 2 - 2 * genus for one closed piece
  double volume_mm3 = 0.0;         ///< enclosed, positive when faces wind outward
  double area_mm2 = 0.0;
  double smallest_angle_deg = 0.0;
  double largest_angle_deg = 0.0;
  double share_below_30_deg = 0.0;  ///< of the triangles: those with an angle below 30 degrees
  /// Circumradius over twice the inradius: 1 for an equilateral triangle, infinite for one without area.
  double worst_aspect = 0.0;
  double mean_aspect = 0.0;
  double sharpest_edge_deg = 0.0;  ///< largest angle between the normals of two triangles at an edge
  Box3 bounds_mm;

  bool closed() const { return triangles > 0 && boundary_edges == 0 && rejected_faces == 0; }
};

/// Measures a mesh. Throws Error when an index is out of range.
MeshQuality measure_mesh(const TriangleMesh& mesh);

/// How rough a surface is: the spread of its normals within a ball around each vertex, degrees, averaged over vertices
/// by the area around them. The spread is the root mean square angle between the normals and their mean, on the part of
/// the surface in the ball that faces the same way as the vertex. A surface with radius of curvature R has about
/// 57 * radius_mm / (1.4 R) of it without being rough, so compare with that of the ground truth.
/// Throws Error on an empty mesh, and on a radius that is not above 0.
double roughness_deg(const TriangleMesh& mesh, double radius_mm = 1.0);

}  // namespace spinaltap
