#pragma once

#include <span>
#include <vector>

#include "core/base/scalar_field.h"
#include "core/base/triangle_mesh.h"

namespace spinaltap {

/// Figures of many distances, mm.
struct MeshDistance {
  double mean_mm = 0.0;
  double p99_mm = 0.0;
  double max_mm = 0.0;
};

/// How far a mesh's triangles lie from a field's zero set: at corners, at the middles of edges and at seven places
/// within each triangle. Value over slope, or the way along the gradient where that is shorter. All 0 for an empty
/// mesh.
MeshDistance mesh_to_surface(const TriangleMesh& mesh, const ScalarField& surface);

/// How far points of a surface lie from a mesh's triangles. All infinite when the mesh has none.
MeshDistance surface_to_mesh(std::span<const Vec3> surface_points_mm, const TriangleMesh& mesh);

namespace detail {

/// The places that mesh_to_surface() looks at, kDistancesOfTriangle for each triangle in turn, and their distances.
/// Those up to `trusted_band_mm` are value over slope.
inline constexpr std::size_t kDistancesOfTriangle = 13;
std::vector<Vec3> places_of_triangles_mm(const TriangleMesh& mesh);
std::vector<double> triangle_distances_mm(const TriangleMesh& mesh, const ScalarField& surface, double trusted_band_mm);

/// The distance of each point.
std::vector<double> point_distances_mm(std::span<const Vec3> surface_points_mm, const TriangleMesh& mesh);

MeshDistance figures_of(std::vector<double> distances_mm);

}  // namespace detail
}  // namespace spinaltap
