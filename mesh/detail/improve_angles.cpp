// The last stage of remeshing: works on thin triangles only, and only by steps that enlarge the smallest angle around.

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "mesh/detail/adaptive_mesh.h"
#include "mesh/detail/triangle_shape.h"

namespace spinaltap::detail {
namespace {

constexpr double kMinGain = 1e-4;  // of a cosine

}  // namespace

bool AdaptiveMesh::improve_by_flip(Face f) {
  Edge best;
  double best_cosine = 2.0;
  for (auto e = mesh_.cfe_iter(f); e.is_valid(); ++e) {
    const Flip flip = look_at_flip(*e);
    if (!flip.allowed || flip.after.angle_cosine > flip.before.angle_cosine - kMinGain) continue;
    if (flip.after.angle_cosine < best_cosine && mesh_.is_flip_ok(*e)) {
      best = *e;
      best_cosine = flip.after.angle_cosine;
    }
  }
  if (!best.is_valid()) return false;
  mesh_.flip(best);
  return true;
}

bool AdaptiveMesh::improve_by_collapse(Face f) {
  constexpr double kLongest = 1.8;  // over what is wanted
  Halfedge best;
  double best_cosine = 2.0;
  for (auto start = mesh_.cfh_iter(f); start.is_valid(); ++start) {
    const Halfedge forth = *start;
    for (const Halfedge h : {forth, mesh_.opposite_halfedge_handle(forth)}) {
      const Collapse collapse = look_at_collapse(h);
      if (!collapse.allowed || collapse.longest_share > kLongest) continue;
      if (collapse.after.angle_cosine > collapse.before.angle_cosine - kMinGain) continue;
      if (collapse.after.angle_cosine < best_cosine && mesh_.is_collapse_ok(h)) {
        best = h;
        best_cosine = collapse.after.angle_cosine;
      }
    }
  }
  if (!best.is_valid()) return false;
  mesh_.collapse(best);
  return true;
}

bool AdaptiveMesh::improve_by_move(Vertex v) {
  double mean_mm = 0.0;
  unsigned valence = 0;
  for (auto n = mesh_.cvv_iter(v); n.is_valid(); ++n) {
    mean_mm += (at(*n) - at(v)).norm();
    ++valence;
  }
  mean_mm /= valence;
  const Vec3 u = any_perpendicular(normal(v));
  const Vec3 w = normal(v).cross(u);
  constexpr std::size_t kDirections = 8;
  constexpr std::array<double, 4> kSteps{0.4, 0.2, 0.08, 0.03};
  std::array<Vec3, kDirections * kSteps.size()> at_mm;
  std::array<double, kDirections * kSteps.size()> reach_mm;
  std::array<ZeroSet::Place, kDirections * kSteps.size()> places;
  reach_mm.fill(mean_mm);
  for (std::size_t i = 0; i < at_mm.size(); ++i) {
    const double turn = 2.0 * std::numbers::pi * static_cast<double>(i % kDirections) / kDirections;
    at_mm[i] = at(v) + kSteps[i / kDirections] * mean_mm * (std::cos(turn) * u + std::sin(turn) * w);
  }
  zero_set_.project(at_mm, reach_mm, places);
  const Worst before = ring_worst(v);
  double best_cosine = before.angle_cosine - kMinGain;
  const ZeroSet::Place* best = nullptr;
  for (const ZeroSet::Place& place : places) {
    if (!place.found || place.normal.dot(normal(v)) < kMinAgreement) continue;
    const Worst after = ring_worst_if(v, place.position_mm, place.normal);
    if (after.agreement < std::min(kMinAgreement, before.agreement) || after.angle_cosine >= best_cosine) continue;
    best = &place;
    best_cosine = after.angle_cosine;
  }
  if (best == nullptr) return false;
  place(v, best->position_mm);
  mesh_.data(v).surface_normal = best->normal;
  return true;
}

bool AdaptiveMesh::improve_by_split(Face f) {
  Edge longest;
  double length_mm = 0.0;
  for (auto e = mesh_.cfe_iter(f); e.is_valid(); ++e) {
    if (mesh_.calc_edge_length(*e) > length_mm) {
      length_mm = mesh_.calc_edge_length(*e);
      longest = *e;
    }
  }
  split_edge(longest);
  return true;
}

bool AdaptiveMesh::improve_face(Face f) {
  if (improve_by_flip(f) || improve_by_collapse(f)) return true;
  bool moved = false;
  std::array<Vertex, 3> corners;
  std::size_t next = 0;
  for (auto v = mesh_.cfv_iter(f); v.is_valid(); ++v) corners[next++] = *v;
  for (const Vertex v : corners) moved = improve_by_move(v) || moved;
  return moved;
}

std::size_t AdaptiveMesh::improve_angles(double wanted_rad) {
  const double wanted_cosine = std::cos(wanted_rad);
  constexpr int kPasses = 24;
  std::size_t thin = 0;
  for (int pass = 0; pass < kPasses; ++pass) {
    thin = 0;
    bool changed = false;
    const std::size_t faces = mesh_.n_faces();
    for (std::size_t i = 0; i < faces; ++i) {
      const Face f(static_cast<int>(i));
      if (mesh_.status(f).deleted() || face_angle_cosine(f) <= wanted_cosine) continue;
      ++thin;
      changed = improve_face(f) || changed;
    }
    // What no single step improves, new vertices may.
    if (thin > 0 && (!changed || pass % 6 == 5)) {
      for (std::size_t i = 0; i < faces; ++i) {
        const Face f(static_cast<int>(i));
        if (!mesh_.status(f).deleted() && face_angle_cosine(f) > wanted_cosine) improve_by_split(f);
      }
    }
    if (thin == 0) break;
  }
  return thin;
}

}  // namespace spinaltap::detail
