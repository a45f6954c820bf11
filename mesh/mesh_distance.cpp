#include "mesh/mesh_distance.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "mesh/detail/triangle_grid.h"
#include "mesh/detail/zero_set.h"

namespace spinaltap {
namespace {

/// Where a triangle is looked at: corners, middles of edges, and within, as shares of its corners.
constexpr std::array<std::array<double, 3>, detail::kDistancesOfTriangle> kPlaces{{{1.0, 0.0, 0.0},
                                                                                   {0.0, 1.0, 0.0},
                                                                                   {0.0, 0.0, 1.0},
                                                                                   {0.5, 0.5, 0.0},
                                                                                   {0.0, 0.5, 0.5},
                                                                                   {0.5, 0.0, 0.5},
                                                                                   {1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0},
                                                                                   {0.5, 0.25, 0.25},
                                                                                   {0.25, 0.5, 0.25},
                                                                                   {0.25, 0.25, 0.5},
                                                                                   {2.0 / 3.0, 1.0 / 6.0, 1.0 / 6.0},
                                                                                   {1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0},
                                                                                   {1.0 / 6.0, 1.0 / 6.0, 2.0 / 3.0}}};

}  // namespace

MeshDistance mesh_to_surface(const TriangleMesh& mesh, const ScalarField& surface) {
  return detail::figures_of(detail::triangle_distances_mm(mesh, surface, 0.0));
}

MeshDistance surface_to_mesh(std::span<const Vec3> surface_points_mm, const TriangleMesh& mesh) {
  return detail::figures_of(detail::point_distances_mm(surface_points_mm, mesh));
}

namespace detail {

std::vector<Vec3> places_of_triangles_mm(const TriangleMesh& mesh) {
  std::vector<Vec3> points_mm;
  points_mm.reserve(kPlaces.size() * mesh.triangles.size());
  for (const auto& t : mesh.triangles) {
    for (const auto& share : kPlaces) {
      Vec3 p = Vec3::Zero();
      for (std::size_t c = 0; c < 3; ++c) p += share[c] * mesh.vertices_mm[t[c]].cast<double>();
      points_mm.push_back(p);
    }
  }
  return points_mm;
}

std::vector<double> triangle_distances_mm(const TriangleMesh& mesh, const ScalarField& surface,
                                          double trusted_band_mm) {
  const std::vector<Vec3> points_mm = places_of_triangles_mm(mesh);
  const ZeroSet zero_set(surface);
  std::vector<double> distances_mm = zero_set.distances_mm(points_mm);
  for (double& d : distances_mm) d = std::abs(d);
  // Where two sheets meet in a crease the slope is small and says too much: there the way to the zero set is measured,
  // which the distance cannot be more than.
  std::vector<std::size_t> suspect;
  std::vector<Vec3> from_mm;
  std::vector<double> reach_mm;
  for (std::size_t i = 0; i < distances_mm.size(); ++i) {
    if (!(distances_mm[i] > trusted_band_mm)) continue;
    suspect.push_back(i);
    from_mm.push_back(points_mm[i]);
    reach_mm.push_back(2.0 * distances_mm[i]);
  }
  std::vector<ZeroSet::Place> places(suspect.size());
  zero_set.project(from_mm, reach_mm, places);
  for (std::size_t n = 0; n < suspect.size(); ++n) {
    if (!places[n].found) continue;
    const double way_mm = (places[n].position_mm - from_mm[n]).norm() + std::abs(places[n].distance_mm);
    distances_mm[suspect[n]] = std::min(distances_mm[suspect[n]], way_mm);
  }
  return distances_mm;
}

std::vector<double> point_distances_mm(std::span<const Vec3> surface_points_mm, const TriangleMesh& mesh) {
  const TriangleGrid grid(mesh);
  std::vector<double> distances_mm(surface_points_mm.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, distances_mm.size(), 1024), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) distances_mm[i] = grid.distance_mm(surface_points_mm[i]);
  });
  return distances_mm;
}

MeshDistance figures_of(std::vector<double> distances_mm) {
  MeshDistance figures;
  if (distances_mm.empty()) return figures;
  for (const double d : distances_mm) figures.mean_mm += d;
  figures.mean_mm /= static_cast<double>(distances_mm.size());
  const auto p99 = distances_mm.begin() + static_cast<std::ptrdiff_t>((distances_mm.size() - 1) * 99 / 100);
  std::nth_element(distances_mm.begin(), p99, distances_mm.end());
  figures.p99_mm = *p99;
  figures.max_mm = *std::max_element(p99, distances_mm.end());
  return figures;
}

}  // namespace detail
}  // namespace spinaltap
