#include "mesh/remesh.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/base/error.h"
#include "mesh/detail/adaptive_mesh.h"
#include "mesh/detail/sizing_field.h"
#include "mesh/detail/triangle_shape.h"
#include "mesh/detail/zero_set.h"
#include "mesh/mesh_distance.h"
#include "mesh/self_intersections.h"

namespace spinaltap {
namespace {

using detail::AdaptiveMesh;
using detail::SizingField;
using detail::ZeroSet;

void require(const RemeshOptions& options, const TriangleMesh& start) {
  if (!(options.max_error_mm > 0.0)) fail("remeshing: expected an error above 0 mm, found ", options.max_error_mm);
  if (!(options.smallest_angle_deg >= 0.0 && options.smallest_angle_deg <= 25.0)) {
    fail("remeshing: expected a smallest angle from 0 to 25 degrees, found ", options.smallest_angle_deg);
  }
  if (!(options.shortest_edge_mm > 0.0 && options.longest_edge_mm >= options.shortest_edge_mm &&
        std::isfinite(options.longest_edge_mm))) {
    fail("remeshing: expected edges above 0 mm, the shortest first, found ", options.shortest_edge_mm, " and ",
         options.longest_edge_mm);
  }
  if (start.triangles.empty()) fail("remeshing: the surface has no triangles");
  for (const auto& t : start.triangles) {
    for (const std::uint32_t corner : t) {
      if (corner >= start.vertices_mm.size()) fail("mesh: vertex ", corner, " of ", start.vertices_mm.size());
    }
  }
}

/// Mean length of the edges at each vertex, mm.
std::vector<double> edge_lengths_mm(const TriangleMesh& mesh) {
  std::vector<double> sums_mm(mesh.vertices_mm.size(), 0.0);
  std::vector<double> counts(mesh.vertices_mm.size(), 0.0);
  for (const auto& t : mesh.triangles) {
    for (std::size_t c = 0; c < 3; ++c) {
      sums_mm[t[c]] += static_cast<double>((mesh.vertices_mm[t[c]] - mesh.vertices_mm[t[(c + 1) % 3]]).norm());
      counts[t[c]] += 1.0;
    }
  }
  for (std::size_t i = 0; i < sums_mm.size(); ++i) sums_mm[i] /= std::max(counts[i], 1.0);
  return sums_mm;
}

/// The start's vertices on the zero set. One that does not get there, or lands on another sheet, stays.
std::vector<ZeroSet::Place> on_surface(const TriangleMesh& start, const ZeroSet& zero_set) {
  std::vector<Vec3> points_mm;
  points_mm.reserve(start.vertices_mm.size());
  for (const Eigen::Vector3f& p : start.vertices_mm) points_mm.push_back(p.cast<double>());
  const std::vector<double> reach_mm = edge_lengths_mm(start);
  std::vector<Vec3> normals = detail::area_normals(start);
  for (Vec3& normal : normals) normal.normalize();
  std::vector<ZeroSet::Place> places(points_mm.size());
  zero_set.project(points_mm, reach_mm, places);
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (places[i].found && places[i].normal.dot(normals[i]) > 0.2) continue;
    places[i].position_mm = points_mm[i];
    places[i].normal = normals[i];
    places[i].found = false;
  }
  return places;
}

Vec3 centre_of(const TriangleMesh& mesh, std::size_t triangle) {
  const auto& t = mesh.triangles[triangle];
  return (mesh.vertices_mm[t[0]] + mesh.vertices_mm[t[1]] + mesh.vertices_mm[t[2]]).cast<double>() / 3.0;
}

/// What a mesh is measured against, and the places where it falls short.
class Check {
 public:
  Check(const RemeshOptions& options, const ScalarField& surface, std::vector<Vec3> surface_points_mm,
        const SizingField& sizing)
      : options_(options), surface_(surface), surface_points_mm_(std::move(surface_points_mm)), sizing_(sizing) {}

  /// Measures; what needs shorter edges goes to `caps`.
  RemeshReport operator()(const TriangleMesh& mesh, std::vector<SizingField::Cap>& caps) const {
    caps.clear();
    RemeshReport report;
    const auto ask = [&](const Vec3& place_mm, double share, double floor_mm) {
      const double length_mm = sizing_.at(place_mm);
      const double shorter_mm = std::max(share * length_mm, floor_mm);
      if (shorter_mm < 0.999 * length_mm) caps.push_back({place_mm, length_mm, shorter_mm});
    };
    const auto ask_for_error = [&](const Vec3& place_mm, double error_mm) {
      // The error goes with the square of the length.
      const double share = std::clamp(0.95 * std::sqrt(options_.max_error_mm / error_mm), 0.6, 0.95);
      ask(place_mm, share, options_.shortest_edge_mm);
    };
    const std::vector<double> to_mm = detail::triangle_distances_mm(mesh, surface_, options_.max_error_mm);
    report.to_surface = detail::figures_of(to_mm);
    for (std::size_t i = 0; i < to_mm.size(); ++i) {
      if (to_mm[i] > options_.max_error_mm) ask_for_error(centre_of(mesh, i / detail::kDistancesOfTriangle), to_mm[i]);
    }
    const std::vector<double> from_mm = detail::point_distances_mm(surface_points_mm_, mesh);
    report.from_surface = detail::figures_of(from_mm);
    for (std::size_t i = 0; i < from_mm.size(); ++i) {
      if (from_mm[i] > options_.max_error_mm) ask_for_error(surface_points_mm_[i], from_mm[i]);
    }
    // Handles and sheets smaller than the shortest edge need shorter ones still.
    const double floor_mm = 0.2 * options_.shortest_edge_mm;
    double largest_cosine = 0.5;
    const double wanted_cosine = std::cos(options_.smallest_angle_deg * std::numbers::pi / 180.0);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto corner = [&](std::size_t c) -> Vec3 { return mesh.vertices_mm[mesh.triangles[t][c]].cast<double>(); };
      const double cosine = detail::smallest_angle_cosine(corner(0), corner(1), corner(2));
      largest_cosine = std::max(largest_cosine, cosine);
      if (cosine > wanted_cosine) ask(centre_of(mesh, t), 0.7, floor_mm);
    }
    report.smallest_angle_deg = std::acos(std::min(largest_cosine, 1.0)) * 180.0 / std::numbers::pi;
    const auto pairs = self_intersections(mesh);
    report.self_intersections = pairs.size();
    for (const auto& pair : pairs) {
      for (const std::uint32_t t : pair) ask(centre_of(mesh, t), 0.6, floor_mm);
    }
    report.reached = report.to_surface.max_mm <= options_.max_error_mm &&
                     report.from_surface.max_mm <= options_.max_error_mm && largest_cosine <= wanted_cosine &&
                     pairs.empty();
    return report;
  }

 private:
  const RemeshOptions& options_;
  const ScalarField& surface_;
  std::vector<Vec3> surface_points_mm_;
  const SizingField& sizing_;
};

}  // namespace

TriangleMesh remesh(const TriangleMesh& start, const ScalarField& surface, const RemeshOptions& options,
                    RemeshReport* report, const Progress& progress) {
  require(options, start);
  constexpr std::string_view kStage = "remeshing";
  progress.report(kStage, 0.0);
  const ZeroSet zero_set(surface);
  const std::vector<ZeroSet::Place> places = on_surface(start, zero_set);
  std::vector<Vec3> points_mm;
  std::vector<Vec3> normals;
  std::vector<Vec3> reference_mm;  // points that are on the zero set, to measure from
  for (const ZeroSet::Place& place : places) {
    points_mm.push_back(place.position_mm);
    normals.push_back(place.normal);
    if (place.found && std::abs(place.distance_mm) < 0.1 * options.max_error_mm) {
      reference_mm.push_back(place.position_mm);
    }
  }
  // Edges may get a third longer than wanted, and the error goes with the square: this keeps most triangles within it.
  constexpr double kErrorShare = 0.65;
  SizingField sizing(points_mm, normals, start.triangles,
                     {.error_mm = kErrorShare * options.max_error_mm,
                      .shortest_mm = options.shortest_edge_mm,
                      .longest_mm = options.longest_edge_mm});
  progress.report(kStage, 0.1);
  AdaptiveMesh mesh(start, places, sizing, zero_set);
  const Check check(options, surface, std::move(reference_mm), sizing);

  constexpr std::size_t kCoarsenings = 10;
  for (std::size_t i = 0; i < kCoarsenings; ++i) {
    const std::size_t before = mesh.mesh().n_vertices();
    const std::size_t collapses = mesh.collapse_short_edges();
    mesh.compact();
    progress.report(kStage, 0.1 + 0.2 * static_cast<double>(i + 1) / kCoarsenings);
    if (collapses < before / 50) break;
  }

  constexpr std::size_t kMaxRounds = 12;
  constexpr std::size_t kFirstPasses = 8;
  constexpr std::size_t kLaterPasses = 3;
  const double wanted_rad = (options.smallest_angle_deg + 5.0) * std::numbers::pi / 180.0;
  RemeshReport reached;
  TriangleMesh result;
  std::vector<SizingField::Cap> caps;
  for (std::size_t round = 0; round < kMaxRounds; ++round) {
    const std::size_t passes = round == 0 ? kFirstPasses : kLaterPasses;
    for (std::size_t pass = 0; pass < passes; ++pass) {
      mesh.split_long_edges();
      mesh.collapse_short_edges();
      mesh.compact();
      mesh.flip_edges();
      mesh.relax();
      const double part = static_cast<double>(pass + 1) / static_cast<double>(passes);
      progress.report(kStage,
                      round == 0 ? 0.3 + 0.3 * part : 0.6 + 0.4 * (static_cast<double>(round - 1) + part) / kMaxRounds);
    }
    mesh.flip_edges();
    mesh.improve_angles(wanted_rad);
    mesh.compact();
    result = mesh.triangles();
    reached = check(result, caps);
    reached.rounds = round;
    if (reached.reached || caps.empty()) break;
    sizing.refine(caps);
    mesh.update_lengths();
  }
  if (report != nullptr) *report = reached;
  progress.report(kStage, 1.0);
  return result;
}

}  // namespace spinaltap
