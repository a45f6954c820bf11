#include "mesh/detail/adaptive_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/error.h"
#include "mesh/detail/half_edge_mesh.h"
#include "mesh/detail/triangle_shape.h"

namespace spinaltap::detail {
namespace {

/// Over what is wanted, an edge is split (Botsch & Kobbelt 2004).
constexpr double kLong = 4.0 / 3.0;

bool agrees(double after, double before) { return after >= std::min(kMinAgreement, before); }

}  // namespace

AdaptiveMesh::AdaptiveMesh(const TriangleMesh& start, std::span<const ZeroSet::Place> places, const SizingField& sizing,
                           const ZeroSet& zero_set)
    : sizing_(sizing), zero_set_(zero_set) {
  const SilencedOutput silenced;
  mesh_.reserve(start.vertices_mm.size(), start.triangles.size() * 3 / 2, start.triangles.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Vertex v = add_vertex(places[i].position_mm);
    mesh_.data(v).surface_normal = places[i].normal;
    mesh_.data(v).length_mm = sizing.at_point(i);
  }
  for (const auto& t : start.triangles) {
    const auto corner = [&](std::size_t c) { return Vertex(static_cast<int>(t[c])); };
    const bool degenerate = t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
    if (degenerate || !mesh_.add_face(corner(0), corner(1), corner(2)).is_valid()) {
      const Vec3& p = at(corner(0));
      fail("remeshing: expected a manifold surface, found a triangle at (", p.x(), ", ", p.y(), ", ", p.z(),
           ") mm that has two alike corners or shares an edge or a corner with a part that it does not belong to");
    }
  }
  for (const auto edge : mesh_.edges()) {
    if (!mesh_.is_boundary(edge)) continue;
    const Vec3& p = at(mesh_.to_vertex_handle(Halfedge(mesh_.halfedge_handle(edge, 0).idx())));
    fail("remeshing: expected a closed surface, found a border at (", p.x(), ", ", p.y(), ", ", p.z(), ") mm");
  }
}

double AdaptiveMesh::corner_agreement(Vertex a, Vertex b, Vertex c) const {
  return agreement(at(a), at(b), at(c), normal(a), normal(b), normal(c));
}

double AdaptiveMesh::angle_cosine(Vertex a, Vertex b, Vertex c) const {
  return smallest_angle_cosine(at(a), at(b), at(c));
}

double AdaptiveMesh::face_angle_cosine(Face f) const {
  const Halfedge h = mesh_.halfedge_handle(f);
  return angle_cosine(mesh_.from_vertex_handle(h), mesh_.to_vertex_handle(h),
                      mesh_.to_vertex_handle(mesh_.next_halfedge_handle(h)));
}

double AdaptiveMesh::face_agreement(Face f) const {
  const Halfedge h = mesh_.halfedge_handle(f);
  return corner_agreement(mesh_.from_vertex_handle(h), mesh_.to_vertex_handle(h),
                          mesh_.to_vertex_handle(mesh_.next_halfedge_handle(h)));
}

AdaptiveMesh::Worst AdaptiveMesh::ring_worst(Vertex v) const { return ring_worst_if(v, at(v), normal(v)); }

AdaptiveMesh::Worst AdaptiveMesh::ring_worst_if(Vertex v, const Vec3& moved_mm, const Vec3& new_normal) const {
  Worst worst;
  for (auto h = mesh_.cvoh_iter(v); h.is_valid(); ++h) {
    const Vertex a = mesh_.to_vertex_handle(*h);
    const Vertex b = mesh_.to_vertex_handle(Halfedge(mesh_.next_halfedge_handle(*h).idx()));
    worst.angle_cosine = std::max(worst.angle_cosine, smallest_angle_cosine(moved_mm, at(a), at(b)));
    worst.agreement = std::min(worst.agreement, agreement(moved_mm, at(a), at(b), new_normal, normal(a), normal(b)));
  }
  return worst;
}

AdaptiveMesh::Collapse AdaptiveMesh::look_at_collapse(Halfedge h) const {
  Collapse collapse;
  const Vertex gone = mesh_.from_vertex_handle(h);
  const Vertex kept = mesh_.to_vertex_handle(h);
  const Halfedge back = mesh_.opposite_halfedge_handle(h);
  const Vertex left = mesh_.to_vertex_handle(mesh_.next_halfedge_handle(h));
  const Vertex right = mesh_.to_vertex_handle(mesh_.next_halfedge_handle(back));
  for (auto out = mesh_.cvoh_iter(gone); out.is_valid(); ++out) {
    const Vertex a = mesh_.to_vertex_handle(*out);
    const Vertex b = mesh_.to_vertex_handle(Halfedge(mesh_.next_halfedge_handle(*out).idx()));
    collapse.before.angle_cosine = std::max(collapse.before.angle_cosine, angle_cosine(gone, a, b));
    collapse.before.agreement = std::min(collapse.before.agreement, corner_agreement(gone, a, b));
    if (a == kept || b == kept) continue;
    collapse.after.angle_cosine = std::max(collapse.after.angle_cosine, angle_cosine(kept, a, b));
    collapse.after.agreement = std::min(collapse.after.agreement, corner_agreement(kept, a, b));
    const double share = (at(a) - at(kept)).norm() / wanted_mm(a, kept);
    if (a != left && a != right) collapse.longest_share = std::max(collapse.longest_share, share);
  }
  // A corner of three triangles that loses one is no surface any more.
  constexpr unsigned kMinValence = 4;
  constexpr unsigned kMaxValence = 10;
  collapse.allowed = agrees(collapse.after.agreement, collapse.before.agreement) &&
                     mesh_.valence(left) >= kMinValence && mesh_.valence(right) >= kMinValence &&
                     mesh_.valence(gone) + mesh_.valence(kept) <= kMaxValence + 4;
  return collapse;
}

AdaptiveMesh::Flip AdaptiveMesh::look_at_flip(Edge e) const {
  Flip flip;
  const Halfedge h = mesh_.halfedge_handle(e, 0);
  const Halfedge back = mesh_.opposite_halfedge_handle(h);
  const Vertex a = mesh_.from_vertex_handle(h);
  const Vertex b = mesh_.to_vertex_handle(h);
  const Vertex left = mesh_.to_vertex_handle(mesh_.next_halfedge_handle(h));
  const Vertex right = mesh_.to_vertex_handle(mesh_.next_halfedge_handle(back));
  flip.before.angle_cosine = std::max(angle_cosine(a, b, left), angle_cosine(b, a, right));
  flip.before.agreement = std::min(corner_agreement(a, b, left), corner_agreement(b, a, right));
  flip.after.angle_cosine = std::max(angle_cosine(left, right, b), angle_cosine(right, left, a));
  flip.after.agreement = std::min(corner_agreement(left, right, b), corner_agreement(right, left, a));
  flip.new_length_share = (at(left) - at(right)).norm() / wanted_mm(left, right);
  constexpr unsigned kMinValence = 4;
  flip.allowed = agrees(flip.after.agreement, flip.before.agreement) && mesh_.valence(a) >= kMinValence &&
                 mesh_.valence(b) >= kMinValence;
  return flip;
}

bool AdaptiveMesh::brings_valences_nearer_to_six(Edge e) const {
  const Halfedge h = mesh_.halfedge_handle(e, 0);
  const Halfedge back = mesh_.opposite_halfedge_handle(h);
  const auto off_six = [&](Vertex v, int change) {
    const int valence = static_cast<int>(mesh_.valence(v));
    return (valence + change - 6) * (valence + change - 6);
  };
  const Vertex a = mesh_.from_vertex_handle(h);
  const Vertex b = mesh_.to_vertex_handle(h);
  const Vertex left = mesh_.to_vertex_handle(mesh_.next_halfedge_handle(h));
  const Vertex right = mesh_.to_vertex_handle(mesh_.next_halfedge_handle(back));
  return off_six(a, -1) + off_six(b, -1) + off_six(left, 1) + off_six(right, 1) <
         off_six(a, 0) + off_six(b, 0) + off_six(left, 0) + off_six(right, 0);
}

void AdaptiveMesh::split_edge(Edge e) {
  const Halfedge h = mesh_.halfedge_handle(e, 0);
  const Vertex a = mesh_.from_vertex_handle(h);
  const Vertex b = mesh_.to_vertex_handle(h);
  const Vec3 middle_mm = 0.5 * (at(a) + at(b));
  // So near to the middle that both halves are a good deal shorter than the whole.
  const double reach_mm = 0.25 * (at(a) - at(b)).norm();
  ZeroSet::Place there;
  zero_set_.project({&middle_mm, 1}, {&reach_mm, 1}, {&there, 1});
  Vec3 between = normal(a) + normal(b);
  if (!(between.norm() > 0.1)) between = normal(a);
  between.normalize();
  if (!there.found || there.normal.dot(between) < kMinAgreement) {
    there.position_mm = middle_mm;
    there.normal = between;
  }
  const Worst before{0.0, std::min(face_agreement(mesh_.face_handle(h)),
                                   face_agreement(mesh_.face_handle(mesh_.opposite_halfedge_handle(h))))};
  const Vertex v = add_vertex(middle_mm);
  mesh_.split(e, v);
  mesh_.data(v).length_mm = sizing_.at(there.position_mm);
  if (agrees(ring_worst_if(v, there.position_mm, there.normal).agreement, before.agreement)) {
    place(v, there.position_mm);
    mesh_.data(v).surface_normal = there.normal;
  } else {
    mesh_.data(v).surface_normal = between;
  }
}

std::size_t AdaptiveMesh::split_long_edges() {
  std::size_t splits = 0;
  // New edges come at the end; they are looked at in the next round, which ends even where no length would do.
  const std::size_t edges = mesh_.n_edges();
  for (std::size_t i = 0; i < edges; ++i) {
    const Edge e(static_cast<int>(i));
    if (mesh_.status(e).deleted()) continue;
    const Halfedge h = mesh_.halfedge_handle(e, 0);
    const Vertex a = mesh_.from_vertex_handle(h);
    const Vertex b = mesh_.to_vertex_handle(h);
    if (!((at(a) - at(b)).norm() > kLong * wanted_mm(a, b))) continue;
    split_edge(e);
    ++splits;
  }
  return splits;
}

std::size_t AdaptiveMesh::collapse_short_edges() {
  constexpr double kShort = 4.0 / 5.0;
  std::size_t collapses = 0;
  for (std::size_t i = 0; i < mesh_.n_edges(); ++i) {
    const Edge e(static_cast<int>(i));
    if (mesh_.status(e).deleted()) continue;
    Halfedge h = mesh_.halfedge_handle(e, 0);
    const Vertex a = mesh_.from_vertex_handle(h);
    const Vertex b = mesh_.to_vertex_handle(h);
    if (!((at(a) - at(b)).norm() < kShort * wanted_mm(a, b))) continue;
    // What the finer place wants stays.
    if (mesh_.data(a).length_mm < mesh_.data(b).length_mm) h = mesh_.opposite_halfedge_handle(h);
    for (const Halfedge way : {h, mesh_.opposite_halfedge_handle(h)}) {
      const Collapse collapse = look_at_collapse(way);
      if (!collapse.allowed || collapse.longest_share > kLong || !mesh_.is_collapse_ok(way)) continue;
      mesh_.collapse(way);
      ++collapses;
      break;
    }
  }
  return collapses;
}

std::size_t AdaptiveMesh::flip_edges() {
  // Valences matter only while no triangle gets thin by it.
  const double fair_cosine = std::cos(30.0 * std::numbers::pi / 180.0);
  std::size_t flips = 0;
  for (const auto e : mesh_.edges()) {
    const Flip flip = look_at_flip(e);
    if (!flip.allowed || flip.new_length_share > 1.5 * kLong) continue;
    const bool rounder =
        flip.after.angle_cosine < flip.before.angle_cosine - 1e-3 && flip.before.angle_cosine > fair_cosine;
    const bool evener = flip.after.angle_cosine < fair_cosine && brings_valences_nearer_to_six(e);
    if ((rounder || evener) && mesh_.is_flip_ok(e)) {
      mesh_.flip(e);
      ++flips;
    }
  }
  return flips;
}

void AdaptiveMesh::relax() {
  std::vector<Vertex> vertices;
  std::vector<Vec3> targets_mm;
  std::vector<double> reach_mm;
  for (const auto v : mesh_.vertices()) {
    Vec3 sum = Vec3::Zero();
    double weights = 0.0;
    double nearest_squared = std::numeric_limits<double>::max();
    for (auto h = mesh_.cvoh_iter(v); h.is_valid(); ++h) {
      const Vertex a = mesh_.to_vertex_handle(*h);
      const Vertex b = mesh_.to_vertex_handle(Halfedge(mesh_.next_halfedge_handle(*h).idx()));
      // An area in units of what is wanted there.
      const double length = (mesh_.data(v).length_mm + mesh_.data(a).length_mm + mesh_.data(b).length_mm) / 3.0;
      const double weight = (at(a) - at(v)).cross(at(b) - at(v)).norm() / (length * length);
      sum += weight * (at(v) + at(a) + at(b)) / 3.0;
      weights += weight;
      nearest_squared = std::min(nearest_squared, (at(a) - at(v)).squaredNorm());
    }
    if (!(weights > 0.0)) continue;
    Vec3 move = sum / weights - at(v);
    move -= normal(v) * normal(v).dot(move);
    vertices.push_back(v);
    targets_mm.push_back(at(v) + move);
    reach_mm.push_back(0.5 * mesh_.data(v).length_mm);
  }
  std::vector<ZeroSet::Place> places(vertices.size());
  zero_set_.project(targets_mm, reach_mm, places);
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const Vertex v = vertices[i];
    const ZeroSet::Place& there = places[i];
    if (!there.found || there.normal.dot(normal(v)) < kMinAgreement) continue;
    const Worst before = ring_worst(v);
    const Worst after = ring_worst_if(v, there.position_mm, there.normal);
    if (!agrees(after.agreement, before.agreement)) continue;
    place(v, there.position_mm);
    mesh_.data(v).surface_normal = there.normal;
    mesh_.data(v).length_mm = sizing_.at(there.position_mm);
  }
}

void AdaptiveMesh::update_lengths() {
  for (const auto v : mesh_.vertices()) mesh_.data(v).length_mm = sizing_.at(at(v));
}

TriangleMesh AdaptiveMesh::triangles() const {
  TriangleMesh result;
  std::vector<std::uint32_t> index(mesh_.n_vertices(), 0);
  for (const auto v : mesh_.vertices()) {
    index[static_cast<std::size_t>(v.idx())] = static_cast<std::uint32_t>(result.vertices_mm.size());
    result.vertices_mm.push_back(at(v).cast<float>());
  }
  for (const auto f : mesh_.faces()) {
    std::array<std::uint32_t, 3> corners{};
    std::size_t next = 0;
    for (auto v = mesh_.cfv_iter(f); v.is_valid(); ++v) corners[next++] = index[static_cast<std::size_t>(v->idx())];
    result.triangles.push_back(corners);
  }
  return result;
}

}  // namespace spinaltap::detail
