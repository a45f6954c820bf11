#include "mesh/decimate.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

#include "core/base/error.h"
#include "mesh/detail/collapse_edges.h"
#include "mesh/detail/half_edge_mesh.h"
#include "mesh/mesh_distance.h"
#include "mesh/mesh_quality.h"
#include "mesh/self_intersections.h"

namespace spinaltap {
namespace {

using detail::CollapsedMesh;

double mean_edge_mm(const TriangleMesh& mesh) {
  double sum_mm = 0.0;
  for (const auto& t : mesh.triangles)
    sum_mm += static_cast<double>((mesh.vertices_mm[t[0]] - mesh.vertices_mm[t[1]]).norm());
  return sum_mm / static_cast<double>(mesh.triangles.size());
}

/// The triangles of a mesh by cubes that their middles lie in; cubes in order.
std::vector<std::vector<std::uint32_t>> triangles_by_cube(const TriangleMesh& mesh, double side_mm) {
  std::map<std::array<int, 3>, std::vector<std::uint32_t>> cubes;
  for (std::uint32_t n = 0; n < mesh.triangles.size(); ++n) {
    const auto& [a, b, c] = mesh.triangles[n];
    const Vec3 middle_mm = (mesh.vertices_mm[a] + mesh.vertices_mm[b] + mesh.vertices_mm[c]).cast<double>() / 3.0;
    const Eigen::Array3i at = (middle_mm / side_mm).array().floor().cast<int>();
    cubes[{at.x(), at.y(), at.z()}].push_back(n);
  }
  std::vector<std::vector<std::uint32_t>> parts;
  parts.reserve(cubes.size());
  for (auto& [at, triangles] : cubes) parts.push_back(std::move(triangles));
  return parts;
}

/// Some triangles of a mesh as a mesh of their own, with vertices in ascending order.
CollapsedMesh part_of(const TriangleMesh& mesh, const std::vector<std::uint32_t>& triangles) {
  CollapsedMesh part;
  for (const std::uint32_t n : triangles) {
    part.originals.insert(part.originals.end(), mesh.triangles[n].begin(), mesh.triangles[n].end());
  }
  std::sort(part.originals.begin(), part.originals.end());
  part.originals.erase(std::unique(part.originals.begin(), part.originals.end()), part.originals.end());
  for (const std::uint32_t vertex : part.originals) part.mesh.vertices_mm.push_back(mesh.vertices_mm[vertex]);
  const auto number = [&](std::uint32_t vertex) {
    return static_cast<std::uint32_t>(std::lower_bound(part.originals.begin(), part.originals.end(), vertex) -
                                      part.originals.begin());
  };
  for (const std::uint32_t n : triangles) {
    const auto& [a, b, c] = mesh.triangles[n];
    part.mesh.triangles.push_back({number(a), number(b), number(c)});
  }
  part.passed_mm.resize(triangles.size());
  return part;
}

/// Parts as one mesh again; vertices of one original number are one.
CollapsedMesh joined(const TriangleMesh& mesh, const std::vector<CollapsedMesh>& parts) {
  constexpr std::uint32_t kNone = ~0U;
  std::vector<std::uint32_t> number(mesh.vertices_mm.size(), kNone);
  for (const CollapsedMesh& part : parts) {
    for (const std::uint32_t vertex : part.originals) number[vertex] = 0;
  }
  CollapsedMesh whole;
  for (std::uint32_t vertex = 0; vertex < number.size(); ++vertex) {
    if (number[vertex] == kNone) continue;
    number[vertex] = static_cast<std::uint32_t>(whole.originals.size());
    whole.originals.push_back(vertex);
    whole.mesh.vertices_mm.push_back(mesh.vertices_mm[vertex]);
  }
  for (const CollapsedMesh& part : parts) {
    for (const auto& [a, b, c] : part.mesh.triangles) {
      whole.mesh.triangles.push_back({number[part.originals[a]], number[part.originals[b]], number[part.originals[c]]});
    }
    whole.passed_mm.insert(whole.passed_mm.end(), part.passed_mm.begin(), part.passed_mm.end());
  }
  return whole;
}

/// A mesh in parts that are made coarser side by side, then along their borders, and again where vertices are to stay.
class Decimation {
 public:
  Decimation(const TriangleMesh& mesh, double tolerance_mm)
      : mesh_(mesh),
        tolerance_mm_(tolerance_mm),
        edge_mm_(mean_edge_mm(mesh)),
        cubes_(triangles_by_cube(mesh, kSideEdges * edge_mm_)),
        parts_(cubes_.size()),
        is_stale_(cubes_.size(), 1),
        is_kept_(mesh.vertices_mm.size(), 0),
        is_border_(mesh.vertices_mm.size(), 0) {
    constexpr std::uint32_t kNone = ~0U;
    std::vector<std::uint32_t> cube_of(mesh.vertices_mm.size(), kNone);
    for (std::uint32_t cube = 0; cube < cubes_.size(); ++cube) {
      for (const std::uint32_t triangle : cubes_[cube]) {
        for (const std::uint32_t vertex : mesh.triangles[triangle]) {
          if (cube_of[vertex] == kNone) cube_of[vertex] = cube;
          if (cube_of[vertex] != cube) is_border_[vertex] = 1;
        }
      }
    }
  }

  double edge_mm() const { return edge_mm_; }

  /// Keeps the vertices within a distance of any of some places.
  void keep_near(const std::vector<Vec3>& places_mm, double distance_mm) {
    std::vector<std::uint8_t> is_new(is_kept_.size(), 0);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, is_kept_.size(), 4096), [&](const auto& range) {
      for (std::size_t n = range.begin(); n < range.end(); ++n) {
        if (is_kept_[n] != 0) continue;
        const Vec3 p_mm = mesh_.vertices_mm[n].cast<double>();
        is_new[n] = std::any_of(places_mm.begin(), places_mm.end(), [&](const Vec3& place_mm) {
          return (place_mm - p_mm).squaredNorm() <= distance_mm * distance_mm;
        });
      }
    });
    for (std::size_t cube = 0; cube < cubes_.size(); ++cube) {
      for (const std::uint32_t triangle : cubes_[cube]) {
        for (const std::uint32_t vertex : mesh_.triangles[triangle]) {
          if (is_new[vertex] != 0) is_stale_[cube] = 1;
        }
      }
    }
    for (std::size_t n = 0; n < is_kept_.size(); ++n) {
      if (is_new[n] != 0) is_kept_[n] = 1;
    }
  }

  TriangleMesh result() {
    const detail::CollapseOptions within{tolerance_mm_, tolerance_mm_};
    tbb::parallel_for(std::size_t{0}, cubes_.size(), [&](std::size_t cube) {
      if (is_stale_[cube] == 0) return;
      parts_[cube] = part_of(mesh_, cubes_[cube]);
      detail::collapse_edges(parts_[cube], kept(parts_[cube], is_kept_), within);
      is_stale_[cube] = 0;
    });
    CollapsedMesh whole = joined(mesh_, parts_);
    // Only the borders are left to do, and what lies beside them.
    std::vector<std::uint8_t> is_free(whole.originals.size(), 0);
    for (const auto& t : whole.mesh.triangles) {
      const bool is_at_border =
          std::any_of(t.begin(), t.end(), [&](std::uint32_t n) { return is_border_[whole.originals[n]] != 0; });
      for (const std::uint32_t corner : t) {
        if (is_at_border) is_free[corner] = 1;
      }
    }
    std::vector<std::uint8_t> stays = kept(whole, is_kept_);
    for (std::size_t n = 0; n < stays.size(); ++n) {
      if (is_free[n] == 0) stays[n] = 1;
    }
    if (!detail::collapse_edges(whole, stays, {tolerance_mm_, 0.5 * tolerance_mm_})) {
      fail("decimating: expected parts that fit together");
    }
    return std::move(whole.mesh);
  }

 private:
  static constexpr double kSideEdges = 96.0;  ///< side of a cube, in edges: some ten thousand triangles in each

  static std::vector<std::uint8_t> kept(const CollapsedMesh& part, const std::vector<std::uint8_t>& is_kept) {
    std::vector<std::uint8_t> of_part;
    for (const std::uint32_t vertex : part.originals) of_part.push_back(is_kept[vertex]);
    return of_part;
  }

  const TriangleMesh& mesh_;
  double tolerance_mm_;
  double edge_mm_;
  std::vector<std::vector<std::uint32_t>> cubes_;
  std::vector<CollapsedMesh> parts_;
  std::vector<std::uint8_t> is_stale_;             ///< of each part
  std::vector<std::uint8_t> is_kept_, is_border_;  ///< of each vertex
};

std::vector<Vec3> vertices_of(const TriangleMesh& mesh) {
  std::vector<Vec3> points_mm;
  points_mm.reserve(mesh.vertices_mm.size());
  for (const Eigen::Vector3f& p : mesh.vertices_mm) points_mm.push_back(p.cast<double>());
  return points_mm;
}

/// Measures, and gives the places where what was asked is missed.
std::vector<Vec3> missed_places_mm(const TriangleMesh& result, const TriangleMesh& mesh, double max_error_mm,
                                   RemeshReport& found) {
  std::vector<Vec3> missed_mm;
  const auto measure = [&](const std::vector<Vec3>& places_mm, const TriangleMesh& to) {
    const std::vector<double> distances_mm = detail::point_distances_mm(places_mm, to);
    for (std::size_t n = 0; n < places_mm.size(); ++n) {
      if (distances_mm[n] > max_error_mm) missed_mm.push_back(places_mm[n]);
    }
    return detail::figures_of(distances_mm);
  };
  const std::vector<Vec3> places_mm = detail::places_of_triangles_mm(result);
  found.to_surface = measure(places_mm, mesh);
  found.from_surface = measure(vertices_of(mesh), result);
  const auto crossings = self_intersections(result);
  found.self_intersections = crossings.size();
  for (const auto& pair : crossings) {
    for (const std::uint32_t triangle : pair) {
      const auto first = places_mm.begin() + static_cast<std::ptrdiff_t>(triangle * detail::kDistancesOfTriangle);
      missed_mm.insert(missed_mm.end(), first, first + detail::kDistancesOfTriangle);
    }
  }
  found.reached = missed_mm.empty();
  return missed_mm;
}

}  // namespace

TriangleMesh decimate(const TriangleMesh& mesh, double max_error_mm, RemeshReport* report, const Progress& progress) {
  constexpr std::size_t kMaxRounds = 8;
  constexpr double kFirst = 0.7;  // between vertices the mesh lies further off
  if (!(max_error_mm > 0.0)) fail("decimating: expected an error above 0 mm, found ", max_error_mm);
  const detail::SilencedOutput silenced;
  if (mesh.triangles.empty() || !measure_mesh(mesh).closed() || detail::to_half_edges(mesh).rejected_faces != 0) {
    fail("decimating: expected a mesh that is closed and manifold");
  }
  Decimation decimation(mesh, kFirst * max_error_mm);
  TriangleMesh result;
  RemeshReport found;
  for (found.rounds = 1;; ++found.rounds) {
    progress.report("decimating", static_cast<double>(found.rounds - 1) / static_cast<double>(kMaxRounds));
    result = decimation.result();
    const std::vector<Vec3> missed_mm = missed_places_mm(result, mesh, max_error_mm, found);
    if (found.reached || found.rounds == kMaxRounds) break;
    decimation.keep_near(missed_mm, 2.0 * static_cast<double>(found.rounds) * decimation.edge_mm());
  }
  progress.report("decimating", 1.0);
  found.smallest_angle_deg = measure_mesh(result).smallest_angle_deg;
  if (report != nullptr) *report = found;
  return result;
}

}  // namespace spinaltap
