#include "mesh/decimate.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

#include "core/base/error.h"
#include "core/base/point_grid.h"
#include "mesh/detail/closed_manifold.h"
#include "mesh/detail/collapse_edges.h"
#include "mesh/detail/triangle_grid.h"
#include "mesh/mesh_distance.h"
#include "mesh/mesh_quality.h"
#include "mesh/self_intersections.h"

namespace spinaltap {
namespace {

using detail::CollapsedPart;
using detail::CreaseVertex;
using detail::FineSurface;
using detail::kNoVertex;
using detail::PassedVertices;

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

/// Some triangles of a mesh as a part of their own, with vertices in ascending order.
CollapsedPart part_of(const TriangleMesh& mesh, const std::vector<CreaseVertex>& creases,
                      const std::vector<std::uint32_t>& triangles) {
  CollapsedPart part;
  for (const std::uint32_t n : triangles) {
    part.originals.insert(part.originals.end(), mesh.triangles[n].begin(), mesh.triangles[n].end());
  }
  std::sort(part.originals.begin(), part.originals.end());
  part.originals.erase(std::unique(part.originals.begin(), part.originals.end()), part.originals.end());
  for (const std::uint32_t vertex : part.originals) part.creases.push_back(creases[vertex]);
  const auto number = [&](std::uint32_t vertex) {
    return static_cast<std::uint32_t>(std::lower_bound(part.originals.begin(), part.originals.end(), vertex) -
                                      part.originals.begin());
  };
  for (const std::uint32_t n : triangles) {
    const auto& [a, b, c] = mesh.triangles[n];
    part.triangles.push_back({number(a), number(b), number(c)});
  }
  part.passed.assign(triangles.size(), kNoVertex);
  return part;
}

/// What one part knows of a crease at a border vertex, beside what the others know: each of its two edges lies in one
/// part, or on the border and is as it was.
void add_crease(const CreaseVertex& first, const CreaseVertex& of_part, CreaseVertex& known) {
  if (of_part.kind != first.kind) known.kind = of_part.kind;
  for (std::size_t side = 0; side < 2; ++side) {
    if (of_part.ends[side] == first.ends[side]) continue;
    known.ends[side] = of_part.ends[side];
    known.passed[side] = of_part.passed[side];
  }
}

/// Parts as one again; vertices of one original number are one.
CollapsedPart joined(const std::vector<CreaseVertex>& creases, const std::vector<CollapsedPart>& parts) {
  std::vector<std::uint32_t> number(creases.size(), kNoVertex);
  for (const CollapsedPart& part : parts) {
    for (const std::uint32_t vertex : part.originals) number[vertex] = 0;
  }
  CollapsedPart whole;
  for (std::uint32_t vertex = 0; vertex < number.size(); ++vertex) {
    if (number[vertex] == kNoVertex) continue;
    number[vertex] = static_cast<std::uint32_t>(whole.originals.size());
    whole.originals.push_back(vertex);
    whole.creases.push_back(creases[vertex]);
  }
  for (const CollapsedPart& part : parts) {
    for (std::size_t n = 0; n < part.originals.size(); ++n) {
      const std::uint32_t original = part.originals[n];
      add_crease(creases[original], part.creases[n], whole.creases[number[original]]);
    }
    for (const auto& [a, b, c] : part.triangles) {
      whole.triangles.push_back({number[part.originals[a]], number[part.originals[b]], number[part.originals[c]]});
    }
    whole.passed.insert(whole.passed.end(), part.passed.begin(), part.passed.end());
  }
  return whole;
}

/// A mesh in parts that are made coarser side by side, then along their borders, and again where it is to be finer.
class Decimation {
 public:
  Decimation(const TriangleMesh& mesh, double tolerance_mm)
      : mesh_(mesh),
        edge_mm_(mean_edge_mm(mesh)),
        fine_{mesh, std::vector<float>(mesh.vertices_mm.size(), static_cast<float>(tolerance_mm))},
        halvings_(mesh.vertices_mm.size(), 0),
        creases_(detail::find_creases(mesh, kShortestCrease * tolerance_mm)),
        next_(mesh.vertices_mm.size()),
        cubes_(triangles_by_cube(mesh, kSideEdges * edge_mm_)),
        parts_(cubes_.size()),
        is_stale_(cubes_.size(), 1),
        is_border_(mesh.vertices_mm.size(), 0) {
    std::vector<std::uint32_t> cube_of(mesh.vertices_mm.size(), kNoVertex);
    for (std::uint32_t cube = 0; cube < cubes_.size(); ++cube) {
      for (const std::uint32_t triangle : cubes_[cube]) {
        for (const std::uint32_t vertex : mesh.triangles[triangle]) {
          if (cube_of[vertex] == kNoVertex) cube_of[vertex] = cube;
          if (cube_of[vertex] != cube) is_border_[vertex] = 1;
        }
      }
    }
  }

  double edge_mm() const { return edge_mm_; }

  /// Asks for half the distance within a way of any of some places, and in the end for all vertices there.
  void refine_near(const std::vector<Vec3>& places_mm, double way_mm) {
    constexpr std::uint8_t kMostHalvings = 3;
    const PointGrid places(places_mm, way_mm);
    std::vector<std::uint8_t> is_finer(mesh_.vertices_mm.size(), 0);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, is_finer.size(), 4096), [&](const auto& range) {
      for (std::size_t n = range.begin(); n < range.end(); ++n) {
        const Vec3 p_mm = mesh_.vertices_mm[n].cast<double>();
        if (places.nearest_within(p_mm, way_mm).distance_mm > way_mm) continue;
        is_finer[n] = 1;
        fine_.tolerance_mm[n] *= ++halvings_[n] <= kMostHalvings ? 0.5F : 0.0F;
      }
    });
    for (std::size_t cube = 0; cube < cubes_.size(); ++cube) {
      for (const std::uint32_t triangle : cubes_[cube]) {
        for (const std::uint32_t vertex : mesh_.triangles[triangle]) {
          if (is_finer[vertex] != 0) is_stale_[cube] = 1;
        }
      }
    }
  }

  TriangleMesh result() {
    tbb::parallel_for(std::size_t{0}, cubes_.size(), [&](std::size_t cube) {
      if (is_stale_[cube] == 0) return;
      CollapsedPart part = part_of(mesh_, creases_, cubes_[cube]);
      detail::collapse_edges(fine_, next_, part, std::vector<std::uint8_t>(part.originals.size(), 0));
      parts_[cube] = std::move(part);
      is_stale_[cube] = 0;
    });
    CollapsedPart whole = joined(creases_, parts_);
    // Only the borders are left to do, and what lies beside them.
    std::vector<std::uint8_t> stays(whole.originals.size(), 1);
    for (const auto& t : whole.triangles) {
      const bool is_at_border =
          std::any_of(t.begin(), t.end(), [&](std::uint32_t n) { return is_border_[whole.originals[n]] != 0; });
      for (const std::uint32_t corner : t) {
        if (is_at_border) stays[corner] = 0;
      }
    }
    PassedVertices next = next_;  // the parts may be needed again
    detail::collapse_edges(fine_, next, whole, stays);
    TriangleMesh mesh;
    mesh.vertices_mm = detail::widen_angles(fine_, next, whole, kWantedAngleRad);
    mesh.triangles = std::move(whole.triangles);
    return mesh;
  }

 private:
  static constexpr double kSideEdges = 96.0;       ///< side of a cube, in edges: some ten thousand triangles in each
  static constexpr double kShortestCrease = 20.0;  ///< over the tolerance
  static constexpr double kWantedAngleRad = 7.0 * std::numbers::pi / 180.0;

  const TriangleMesh& mesh_;
  double edge_mm_;
  FineSurface fine_;
  std::vector<std::uint8_t> halvings_;  ///< of each vertex' tolerance
  std::vector<CreaseVertex> creases_;
  PassedVertices next_;
  std::vector<std::vector<std::uint32_t>> cubes_;
  std::vector<CollapsedPart> parts_;
  std::vector<std::uint8_t> is_stale_;   ///< of each part
  std::vector<std::uint8_t> is_border_;  ///< of each vertex
};

std::vector<Vec3> vertices_of(const TriangleMesh& mesh) {
  std::vector<Vec3> points_mm;
  points_mm.reserve(mesh.vertices_mm.size());
  for (const Eigen::Vector3f& p : mesh.vertices_mm) points_mm.push_back(p.cast<double>());
  return points_mm;
}

/// The places where what was asked is missed. No vertex of the first mesh lies further from the result than it may, as
/// collapsing sees to that; places of the result's triangles do.
std::vector<Vec3> missed_places_mm(const TriangleMesh& result, const detail::TriangleGrid& surface, double max_error_mm,
                                   RemeshReport& found) {
  const std::vector<Vec3> places_mm = detail::places_of_triangles_mm(result);
  std::vector<std::uint8_t> is_missed(places_mm.size(), 0);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, places_mm.size(), 1024), [&](const auto& range) {
    for (std::size_t n = range.begin(); n < range.end(); ++n) {
      is_missed[n] = surface.is_within(places_mm[n], max_error_mm) ? 0 : 1;
    }
  });
  const auto crossings = self_intersections(result);
  found.self_intersections = crossings.size();
  for (const auto& pair : crossings) {
    for (const std::uint32_t triangle : pair) {
      const auto first = is_missed.begin() + static_cast<std::ptrdiff_t>(triangle * detail::kDistancesOfTriangle);
      std::fill_n(first, detail::kDistancesOfTriangle, std::uint8_t{1});
    }
  }
  std::vector<Vec3> missed_mm;
  for (std::size_t n = 0; n < places_mm.size(); ++n) {
    if (is_missed[n] != 0) missed_mm.push_back(places_mm[n]);
  }
  found.reached = missed_mm.empty();
  return missed_mm;
}

}  // namespace

TriangleMesh decimate(const TriangleMesh& mesh, double max_error_mm, RemeshReport* report, const Progress& progress) {
  constexpr std::size_t kMaxRounds = 8;
  constexpr double kFirst = 0.7;  // between vertices the mesh lies further off
  if (!(max_error_mm > 0.0)) fail("decimating: expected an error above 0 mm, found ", max_error_mm);
  if (!detail::is_closed_manifold(mesh)) fail("decimating: expected a mesh that is closed and manifold");
  Decimation decimation(mesh, kFirst * max_error_mm);
  const detail::TriangleGrid surface(mesh);
  TriangleMesh result;
  RemeshReport found;
  for (found.rounds = 1;; ++found.rounds) {
    progress.report("decimating", static_cast<double>(found.rounds - 1) / static_cast<double>(kMaxRounds));
    result = decimation.result();
    const std::vector<Vec3> missed_mm = missed_places_mm(result, surface, max_error_mm, found);
    if (found.reached || found.rounds == kMaxRounds) break;
    decimation.refine_near(missed_mm, 2.0 * static_cast<double>(found.rounds) * decimation.edge_mm());
  }
  progress.report("decimating", 1.0);
  if (report != nullptr) {
    *report = found;
    report->to_surface = detail::figures_of(detail::point_distances_mm(detail::places_of_triangles_mm(result), mesh));
    report->from_surface = detail::figures_of(detail::point_distances_mm(vertices_of(mesh), result));
    report->smallest_angle_deg = measure_mesh(result).smallest_angle_deg;
  }
  return result;
}

}  // namespace spinaltap
