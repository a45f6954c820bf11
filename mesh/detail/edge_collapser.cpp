// Garland & Heckbert 1997, "Surface simplification using quadric error metrics", half-edge collapses; Klein, Liebich &
// Strasser 1996, "Mesh reduction with error control": of every vertex that went the triangle near it is known.

#include "mesh/detail/edge_collapser.h"

#include <algorithm>
#include <cmath>

#include "mesh/detail/triangle_shape.h"

namespace spinaltap::detail {
namespace {

constexpr double kLargestTurnCosine = 0.70710678118654752;  // of a triangle's normal by one step: 45 degrees
/// The normal of a thinner triangle says nothing of the surface.
constexpr double kThinCosine = 0.9986;  // 3 degrees

double squared_distance_to_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 along = b - a;
  const double length = along.squaredNorm();
  const double share = length > 0.0 ? std::clamp((p - a).dot(along) / length, 0.0, 1.0) : 0.0;
  return (a + share * along - p).squaredNorm();
}

}  // namespace

EdgeCollapser::EdgeCollapser(const FineSurface& fine, PassedVertices& next, const CollapsedPart& part,
                             const std::vector<std::uint8_t>& is_kept)
    : fine_(fine),
      next_(next),
      originals_(part.originals),
      triangles_(part.triangles),
      creases_(part.creases),
      passed_(part.passed),
      origin_mm_(fine.mesh.vertices_mm[part.originals.front()].cast<double>()),
      fans_(part.originals.size(), part.triangles),
      stays_(is_kept),
      is_border_(part.originals.size(), 0),
      has_moved_(part.originals.size(), 0),
      mark_(part.originals.size(), 0) {
  at_mm_.reserve(originals_.size());
  for (const std::uint32_t original : originals_) at_mm_.push_back(fine_mm(original));
  for (std::uint32_t vertex = 0; vertex < originals_.size(); ++vertex) {
    find_ring(vertex, ring_);
    if (ring_.size() == fans_.of(vertex).size()) continue;
    is_border_[vertex] = 1;
    stays_[vertex] = 1;
  }
}

void EdgeCollapser::find_ring(std::uint32_t vertex, std::vector<std::uint32_t>& ring) {
  ring.clear();
  ++marks_;
  for (const std::uint32_t triangle : fans_.of(vertex)) {
    for (const std::uint32_t corner : triangles_[triangle]) {
      if (corner == vertex || mark_[corner] == marks_) continue;
      mark_[corner] = marks_;
      ring.push_back(corner);
    }
  }
}

double EdgeCollapser::angle_cosine(std::uint32_t triangle) const {
  const auto& [a, b, c] = triangles_[triangle];
  return smallest_angle_cosine(at_mm_[a], at_mm_[b], at_mm_[c]);
}

std::uint32_t EdgeCollapser::local(std::uint32_t original) const {
  return static_cast<std::uint32_t>(std::lower_bound(originals_.begin(), originals_.end(), original) -
                                    originals_.begin());
}

bool EdgeCollapser::follows_crease(std::uint32_t from, std::uint32_t to) const {
  const CreaseVertex& crease = creases_[from];
  if (crease.kind == CreaseVertex::Kind::smooth) return true;
  if (crease.kind == CreaseVertex::Kind::end) return false;
  return crease.ends[0] == originals_[to] || crease.ends[1] == originals_[to];
}

/// The only vertices next to both are those of the two triangles at the edge.
bool EdgeCollapser::keeps_manifold(std::uint32_t from, std::uint32_t to) {
  find_ring(to, other_ring_);
  const std::uint32_t of_to = marks_;
  old_.clear();
  dying_.clear();
  for (const std::uint32_t triangle : fans_.of(from)) {
    const Triangle& t = triangles_[triangle];
    const bool dies = t[0] == to || t[1] == to || t[2] == to;
    (dies ? dying_ : old_).push_back(triangle);
  }
  if (dying_.size() != 2 || old_.empty()) return false;
  std::size_t twice_shared = 0;  // each vertex of the ring is a corner of two triangles
  for (const std::uint32_t triangle : fans_.of(from)) {
    for (const std::uint32_t corner : triangles_[triangle]) {
      if (corner == from || corner == to) continue;
      if (mark_[corner] == of_to) {
        ++twice_shared;
      } else if (is_border_[to] != 0 && is_border_[corner] != 0) {
        return false;  // a new edge from border to border, which another part may have too
      }
    }
  }
  if (twice_shared != 4) return false;
  for (const std::uint32_t triangle : dying_) {
    for (const std::uint32_t corner : triangles_[triangle]) {
      if (corner == from || corner == to) continue;
      if (fans_.of(corner).size() < (is_border_[corner] != 0 ? 2U : 4U)) return false;
    }
  }
  return true;
}

bool EdgeCollapser::add_new(std::uint32_t index, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 normal = (b - a).cross(c - a);
  const double length = normal.norm();
  if (!(length > 0.0)) return false;
  new_.push_back({index, a, b, c, normal / length});
  return true;
}

bool EdgeCollapser::keeps_shape(std::uint32_t from, std::uint32_t to, const Limits& limits) {
  double before = 0.5;
  new_.clear();
  double after = 0.5;
  for (const std::uint32_t triangle : dying_) before = std::max(before, angle_cosine(triangle));
  for (const std::uint32_t triangle : old_) before = std::max(before, angle_cosine(triangle));
  const double allowed = std::max(limits.angle_cosine, before - limits.gain);
  for (const std::uint32_t triangle : old_) {
    const Triangle& t = triangles_[triangle];
    const auto moved = [&](std::size_t c) -> const Vec3& { return t[c] == from ? at_mm_[to] : at_mm_[t[c]]; };
    after = std::max(after, smallest_angle_cosine(moved(0), moved(1), moved(2)));
    if (after > allowed) return false;
    if (!add_new(triangle, moved(0), moved(1), moved(2))) return false;
  }
  return keeps_turns(limits, before);
}

/// Across a triangle, twice its area long.
Vec3 EdgeCollapser::area_normal(std::uint32_t triangle) const {
  const Triangle& t = triangles_[triangle];
  return (at_mm_[t[1]] - at_mm_[t[0]]).cross(at_mm_[t[2]] - at_mm_[t[0]]);
}

Vec3 EdgeCollapser::normals_of(std::span<const std::uint32_t> triangles, std::span<const std::uint32_t> others) const {
  Vec3 sum = Vec3::Zero();
  for (const std::uint32_t triangle : triangles) sum += area_normal(triangle);
  for (const std::uint32_t triangle : others) sum += area_normal(triangle);
  return sum;
}

/// Whether no new triangle faces away from the old one in its place; thin old ones say nothing.
bool EdgeCollapser::keeps_facing() const {
  for (std::size_t n = 0; n < old_.size(); ++n) {
    if (angle_cosine(old_[n]) > kThinCosine) continue;
    const Vec3 normal = area_normal(old_[n]);
    if (normal.dot(new_[n].normal) < kLargestTurnCosine * normal.norm()) return false;
  }
  return true;
}

/// Whether the new triangles face as the old ones do. `before`: the smallest angle's cosine of all that are old.
bool EdgeCollapser::keeps_turns(const Limits& limits, double before) const {
  // Of a spike: the triangle at its foot may face anywhere.
  if (!limits.keeps_creases && old_.size() == 1) return true;
  if (!keeps_facing()) return false;
  if (before <= kThinCosine) return true;
  const Vec3 sum = normals_of(old_, dying_);
  return std::all_of(new_.begin(), new_.end(), [&](const NewTriangle& t) { return t.normal.dot(sum) > 0.0; });
}

/// What was on the crease lies near the edge that takes its place.
bool EdgeCollapser::keeps_crease(std::uint32_t from, std::uint32_t to) {
  const CreaseVertex& crease = creases_[from];
  if (crease.kind == CreaseVertex::Kind::smooth) return true;
  const std::size_t along = crease.ends[0] == originals_[to] ? 0 : 1;
  const std::uint32_t other = crease.ends[1 - along];
  const CreaseVertex& beyond = creases_[local(other)];
  if (other == originals_[to] || beyond.ends[0] == originals_[to] || beyond.ends[1] == originals_[to]) return false;
  const Vec3 begin = fine_mm(other);
  const Vec3& end = at_mm_[to];
  const auto is_near = [&](std::uint32_t vertex) {
    const double tolerance = fine_.crease_share * static_cast<double>(fine_.tolerance_mm[vertex]);
    return squared_distance_to_segment(fine_mm(vertex), begin, end) <= tolerance * tolerance;
  };
  if (!is_near(originals_[from])) return false;
  for (const std::uint32_t first : crease.passed) {
    for (std::uint32_t vertex = first; vertex != kNoVertex; vertex = next_.next_on_crease[vertex]) {
      if (!is_near(vertex)) return false;
    }
  }
  return true;
}

/// Gives a vertex that goes, or went, to the new triangle that is nearest; false where that is not near enough.
bool EdgeCollapser::take_over(std::uint32_t vertex, std::size_t& hint) {
  const Vec3 p = fine_mm(vertex);
  const auto tolerance = static_cast<double>(fine_.tolerance_mm[vertex]);
  const double allowed = tolerance * tolerance;
  double nearest = allowed;
  std::size_t found = new_.size();
  for (std::size_t n = 0; n < new_.size(); ++n) {
    const std::size_t tried = hint + n < new_.size() ? hint + n : hint + n - new_.size();
    const NewTriangle& t = new_[tried];
    const double above = t.normal.dot(p - t.a);
    if (above * above > nearest) continue;
    const double distance = squared_distance(p, t.a, t.b, t.c);
    if (distance > nearest) continue;
    nearest = distance;
    found = tried;
    if (distance <= 0.1 * allowed) break;  // near enough
  }
  if (found == new_.size()) return false;
  hint = found;  // neighbours lie near the same triangle
  moved_.push_back({vertex, static_cast<std::uint32_t>(found)});
  return true;
}

bool EdgeCollapser::take_over_chains(std::span<const std::uint32_t> triangles, std::size_t& hint) {
  for (const std::uint32_t triangle : triangles) {
    for (std::uint32_t vertex = passed_[triangle]; vertex != kNoVertex; vertex = next_.next_of_triangle[vertex]) {
      if (!take_over(vertex, hint)) return false;
    }
  }
  return true;
}

void EdgeCollapser::hand_over() {
  for (const Moved& moved : moved_) {
    std::uint32_t& first = passed_[new_[moved.new_triangle].index];
    next_.next_of_triangle[moved.vertex] = first;
    first = moved.vertex;
  }
}

/// Creases end beside a vertex that leaves them.
void EdgeCollapser::end_creases_at(std::uint32_t vertex) {
  if (creases_[vertex].kind == CreaseVertex::Kind::smooth) return;
  find_ring(vertex, ring_);
  for (const std::uint32_t beside : ring_) {
    CreaseVertex& crease = creases_[beside];
    if (crease.ends[0] == originals_[vertex] || crease.ends[1] == originals_[vertex]) {
      crease.kind = CreaseVertex::Kind::end;
    }
  }
}

void EdgeCollapser::move_crease(std::uint32_t from, std::uint32_t to) {
  const CreaseVertex& crease = creases_[from];
  const std::size_t along = crease.ends[0] == originals_[to] ? 0 : 1;
  const std::uint32_t other = crease.ends[1 - along];
  // Both chains and the vertex itself make the chain of the edge from there to `to`.
  std::uint32_t first = originals_[from];
  next_.next_on_crease[first] = crease.passed[0];
  std::uint32_t last = first;
  while (next_.next_on_crease[last] != kNoVertex) last = next_.next_on_crease[last];
  next_.next_on_crease[last] = crease.passed[1];
  const auto connect = [&](CreaseVertex& end, std::uint32_t new_end) {
    if (end.kind != CreaseVertex::Kind::along) return;
    const std::size_t side = end.ends[0] == originals_[from] ? 0 : 1;
    end.ends[side] = new_end;
    end.passed[side] = first;
  };
  connect(creases_[to], other);
  connect(creases_[local(other)], originals_[to]);
}

bool EdgeCollapser::collapse(std::uint32_t from, std::uint32_t to, const Limits& limits) {
  if (stays(from) || (limits.keeps_creases && !follows_crease(from, to))) return false;
  if (!keeps_manifold(from, to) || !keeps_shape(from, to, limits)) return false;
  const bool is_along = follows_crease(from, to) && creases_[from].kind == CreaseVertex::Kind::along;
  const bool moves_crease = is_along && keeps_crease(from, to);
  if (limits.keeps_creases && is_along && !moves_crease) return false;
  moved_.clear();
  std::size_t hint = 0;
  if (has_moved_[from] == 0 && !take_over(originals_[from], hint)) return false;
  if (!take_over_chains(dying_, hint) || !take_over_chains(old_, hint)) return false;
  if (moves_crease) {
    move_crease(from, to);
  } else {
    end_creases_at(from);
  }
  for (const std::uint32_t triangle : dying_) {
    for (const std::uint32_t corner : triangles_[triangle]) {
      if (corner != from) fans_.remove(corner, triangle);
    }
    triangles_[triangle].fill(kNoVertex);
    passed_[triangle] = kNoVertex;
  }
  for (const std::uint32_t triangle : old_) {
    passed_[triangle] = kNoVertex;
    std::replace(triangles_[triangle].begin(), triangles_[triangle].end(), from, to);
  }
  fans_.clear(from);
  fans_.add(to, old_);
  hand_over();
  return true;
}

bool EdgeCollapser::flip(std::uint32_t a, std::uint32_t b, const Limits& limits) {
  old_.clear();
  for (const std::uint32_t triangle : fans_.of(a)) {
    const Triangle& t = triangles_[triangle];
    if (t[0] == b || t[1] == b || t[2] == b) old_.push_back(triangle);
  }
  if (old_.size() != 2 || fans_.of(a).size() < 4 || fans_.of(b).size() < 4) return false;
  const auto is_end = [&](const CreaseVertex& one, std::uint32_t other) {
    return one.kind == CreaseVertex::Kind::along &&
           (one.ends[0] == originals_[other] || one.ends[1] == originals_[other]);
  };
  const bool is_crease = is_end(creases_[a], b) || is_end(creases_[b], a) ||
                         (creases_[a].kind == CreaseVertex::Kind::end && creases_[b].kind == CreaseVertex::Kind::end);
  if (limits.keeps_creases && is_crease) return false;
  // The first triangle has the edge from a to b, the second from b to a.
  const auto third = [&](std::uint32_t triangle, bool& goes_on) {
    const Triangle& t = triangles_[triangle];
    const std::size_t at = t[0] == a ? 0 : t[1] == a ? 1 : 2;
    goes_on = t[(at + 1) % 3] == b;
    return goes_on ? t[(at + 2) % 3] : t[(at + 1) % 3];
  };
  bool goes_on = false, other_goes_on = false;
  const std::uint32_t c = third(old_[0], goes_on);
  const std::uint32_t d = third(old_[1], other_goes_on);
  if (c == d || goes_on == other_goes_on) return false;
  for (const std::uint32_t triangle : fans_.of(c)) {
    const Triangle& t = triangles_[triangle];
    if (t[0] == d || t[1] == d || t[2] == d) return false;
  }
  const double before = std::max(angle_cosine(old_[0]), angle_cosine(old_[1]));
  Triangle first{a, d, c}, second{b, c, d};
  if (!goes_on) {
    std::swap(first[1], first[2]);
    std::swap(second[1], second[2]);
  }
  new_.clear();
  double after = 0.5;
  for (std::size_t n = 0; n < 2; ++n) {
    const Triangle& t = n == 0 ? first : second;
    after = std::max(after, smallest_angle_cosine(at_mm_[t[0]], at_mm_[t[1]], at_mm_[t[2]]));
    if (after > before - limits.gain || !add_new(old_[n], at_mm_[t[0]], at_mm_[t[1]], at_mm_[t[2]])) return false;
  }
  const Vec3 sum = normals_of(old_);
  for (const NewTriangle& t : new_) {
    if (t.normal.dot(sum) < kLargestTurnCosine * sum.norm()) return false;
  }
  moved_.clear();
  std::size_t hint = 0;
  if (!take_over_chains(old_, hint)) return false;
  if (is_crease) {
    creases_[a].kind = creases_[b].kind = CreaseVertex::Kind::end;
  }
  fans_.remove(b, old_[0]);
  fans_.remove(a, old_[1]);
  fans_.add(d, std::span(old_).first(1));
  fans_.add(c, std::span(old_).last(1));
  triangles_[old_[0]] = first;
  triangles_[old_[1]] = second;
  for (const std::uint32_t triangle : old_) passed_[triangle] = kNoVertex;
  hand_over();
  return true;
}

double EdgeCollapser::mean_edge_mm(std::uint32_t vertex) {
  find_ring(vertex, ring_);
  double sum_mm = 0.0;
  for (const std::uint32_t beside : ring_) sum_mm += (at_mm_[beside] - at_mm_[vertex]).norm();
  return sum_mm / static_cast<double>(ring_.size());
}

bool EdgeCollapser::move(std::uint32_t vertex, const Vec3& to_mm, const Limits& limits) {
  if (stays(vertex) || (limits.keeps_creases && creases_[vertex].kind != CreaseVertex::Kind::smooth)) return false;
  const auto fan = fans_.of(vertex);
  old_.assign(fan.begin(), fan.end());
  dying_.clear();
  new_.clear();
  double before = 0.5, after = 0.5;
  for (const std::uint32_t triangle : old_) before = std::max(before, angle_cosine(triangle));
  for (const std::uint32_t triangle : old_) {
    const Triangle& t = triangles_[triangle];
    const auto moved = [&](std::size_t c) -> const Vec3& { return t[c] == vertex ? to_mm : at_mm_[t[c]]; };
    after = std::max(after, smallest_angle_cosine(moved(0), moved(1), moved(2)));
    if (after > before - limits.gain || !add_new(triangle, moved(0), moved(1), moved(2))) return false;
  }
  if (!keeps_facing()) return false;
  moved_.clear();
  std::size_t hint = 0;
  if (has_moved_[vertex] == 0 && !take_over(originals_[vertex], hint)) return false;
  if (!take_over_chains(old_, hint)) return false;
  has_moved_[vertex] = 1;
  at_mm_[vertex] = to_mm;
  for (const std::uint32_t triangle : old_) passed_[triangle] = kNoVertex;
  hand_over();
  return true;
}

std::vector<Eigen::Vector3f> EdgeCollapser::positions_mm() const {
  std::vector<Eigen::Vector3f> positions_mm;
  for (std::uint32_t vertex = 0; vertex < originals_.size(); ++vertex) {
    if (is_gone(vertex)) continue;
    positions_mm.push_back(has_moved_[vertex] != 0 ? Vec3(at_mm_[vertex] + origin_mm_).cast<float>()
                                                   : fine_.mesh.vertices_mm[originals_[vertex]]);
  }
  return positions_mm;
}

CollapsedPart EdgeCollapser::part() const {
  CollapsedPart result;
  std::vector<std::uint32_t> number(originals_.size(), kNoVertex);
  for (std::uint32_t vertex = 0; vertex < originals_.size(); ++vertex) {
    if (is_gone(vertex)) continue;
    number[vertex] = static_cast<std::uint32_t>(result.originals.size());
    result.originals.push_back(originals_[vertex]);
    result.creases.push_back(creases_[vertex]);
  }
  for (std::uint32_t triangle = 0; triangle < triangles_.size(); ++triangle) {
    if (is_dead(triangle)) continue;
    const auto& [a, b, c] = triangles_[triangle];
    result.triangles.push_back({number[a], number[b], number[c]});
    result.passed.push_back(passed_[triangle]);
  }
  return result;
}

}  // namespace spinaltap::detail
