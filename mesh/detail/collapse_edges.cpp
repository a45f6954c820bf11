#include "mesh/detail/collapse_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <queue>
#include <utility>

#include "mesh/detail/edge_collapser.h"

namespace spinaltap::detail {
namespace {

/// The mean square distance to planes, weighted by the areas of the triangles in them (Garland & Heckbert 1997).
class Quadric {
 public:
  Quadric() = default;
  Quadric(const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 normal = (b - a).cross(c - a);
    const double area = normal.norm();
    if (!(area > 0.0)) return;
    const Vec3 n = normal / area;
    const double d = -n.dot(a);
    area_ = area;
    of_ = {area * n.x() * n.x(), area * n.x() * n.y(), area * n.x() * n.z(), area * n.x() * d, area * n.y() * n.y(),
           area * n.y() * n.z(), area * n.y() * d,     area * n.z() * n.z(), area * n.z() * d, area * d * d};
  }
  Quadric& operator+=(const Quadric& other) {
    for (std::size_t n = 0; n < of_.size(); ++n) of_[n] += other.of_[n];
    area_ += other.area_;
    return *this;
  }
  double sum(const Vec3& p) const {
    return p.x() * (of_[0] * p.x() + 2.0 * (of_[1] * p.y() + of_[2] * p.z() + of_[3])) +
           p.y() * (of_[4] * p.y() + 2.0 * (of_[5] * p.z() + of_[6])) + p.z() * (of_[7] * p.z() + 2.0 * of_[8]) +
           of_[9];
  }
  double area() const { return area_; }

 private:
  std::array<double, 10> of_{};
  double area_ = 0.0;
};

/// The collapses that may be next, and their order.
class CollapseQueue {
 public:
  explicit CollapseQueue(EdgeCollapser& mesh)
      : mesh_(mesh), quadrics_(mesh.vertex_count()), turn_(mesh.vertex_count(), 0), is_queued_(mesh.vertex_count(), 0) {
    for (std::uint32_t triangle = 0; triangle < mesh.triangle_count(); ++triangle) {
      const auto& t = mesh.corners(triangle);
      const Quadric quadric(mesh.at_mm(t[0]), mesh.at_mm(t[1]), mesh.at_mm(t[2]));
      for (const std::uint32_t corner : t) quadrics_[corner] += quadric;
    }
    for (std::uint32_t vertex = 0; vertex < mesh.vertex_count(); ++vertex) push(vertex, kAll);
  }

  /// Collapses until none is left.
  void run(const EdgeCollapser::Limits& limits) {
    while (!queue_.empty()) {
      const Entry next = queue_.top();
      queue_.pop();
      is_queued_[next.from] = 0;
      if (next.turn != turn_[next.from]) {
        push(next.from, kAll);
        continue;
      }
      if (!mesh_.collapse(next.from, next.cost.to, limits)) {
        push(next.from, next.cost);
        continue;
      }
      quadrics_[next.cost.to] += quadrics_[next.from];
      mesh_.find_ring(next.cost.to, changed_);
      changed_.push_back(next.cost.to);
      for (const std::uint32_t vertex : changed_) {
        // Its cost is mostly larger now: early enough to look at it when it is its turn.
        ++turn_[vertex];
        if (is_queued_[vertex] == 0) push(vertex, kAll);
      }
    }
  }

 private:
  struct Cost {
    float mm2;
    std::uint32_t to;
    bool operator<(const Cost& other) const { return std::pair(mm2, to) < std::pair(other.mm2, other.to); }
  };
  static constexpr Cost kAll{-1.0F, 0};  ///< less than any
  struct Entry {
    Cost cost;
    std::uint32_t from;
    std::uint32_t turn;  ///< of the vertex, when the cost was found
    bool operator>(const Entry& other) const { return std::pair(cost, from) > std::pair(other.cost, other.from); }
  };

  /// The vertex's cheapest collapse that costs more than one that was tried.
  void push(std::uint32_t from, const Cost& tried) {
    if (mesh_.stays(from) || mesh_.is_gone(from)) return;
    constexpr double kLength = 1e-4;    // of the square of an edge: short ones first where all is flat
    constexpr double kHopeless = 16.0;  // of the square of the tolerance: it would be rejected
    const double most_mm2 = kHopeless * mesh_.tolerance_mm(from) * mesh_.tolerance_mm(from);
    bool is_found = false;
    Cost best{};
    mesh_.find_ring(from, ring_);
    for (const std::uint32_t to : ring_) {
      if (!mesh_.follows_crease(from, to)) continue;
      const Vec3& p = mesh_.at_mm(to);
      const double area = quadrics_[from].area() + quadrics_[to].area();
      const double off_mm2 = std::max(0.0, quadrics_[from].sum(p) + quadrics_[to].sum(p)) / std::max(area, 1e-30);
      if (off_mm2 > most_mm2) continue;
      const Cost cost{static_cast<float>(off_mm2 + kLength * (p - mesh_.at_mm(from)).squaredNorm()), to};
      if (tried < cost && (!is_found || cost < best)) {
        best = cost;
        is_found = true;
      }
    }
    if (!is_found) return;
    queue_.push({best, from, turn_[from]});
    is_queued_[from] = 1;
  }

  EdgeCollapser& mesh_;
  std::vector<Quadric> quadrics_;
  std::vector<std::uint32_t> turn_;  ///< of each vertex: how often the triangles around it changed
  std::vector<std::uint8_t> is_queued_;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;
  std::vector<std::uint32_t> changed_, ring_;
};

constexpr double kGain = 1e-4;  // of a cosine

/// Moves a vertex to the first of some places around it that does its triangles good: far ones first. Where a hole just
/// meets another surface there are necks of a micrometre, which no collapse may close.
bool spread(EdgeCollapser& mesh, std::uint32_t vertex, const EdgeCollapser::Limits& limits) {
  const double mean_mm = mesh.mean_edge_mm(vertex);
  const Vec3 from_mm = mesh.at_mm(vertex);
  for (const double step : {0.2, 0.1, 0.05, 0.02}) {
    for (int n = 0; n < 27; ++n) {
      if (n == 13) continue;
      const Eigen::Vector3i way(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1);
      if (mesh.move(vertex, from_mm + step * mean_mm * way.cast<double>().normalized(), limits)) return true;
    }
  }
  return false;
}

bool widen(EdgeCollapser& mesh, std::uint32_t triangle, const EdgeCollapser::Limits& limits) {
  const EdgeCollapser::Triangle t = mesh.corners(triangle);
  // Across the longest edge first, along the shortest first: what thin triangles want.
  std::array<std::array<std::uint32_t, 2>, 3> edges{{{t[0], t[1]}, {t[1], t[2]}, {t[2], t[0]}}};
  const auto length = [&](const auto& e) { return (mesh.at_mm(e[0]) - mesh.at_mm(e[1])).squaredNorm(); };
  std::stable_sort(edges.begin(), edges.end(), [&](const auto& e, const auto& f) { return length(e) < length(f); });
  for (std::size_t n = 0; n < edges.size(); ++n) {
    const auto& [a, b] = edges[n];
    if (mesh.collapse(a, b, limits) || mesh.collapse(b, a, limits)) return true;
    const auto& [c, d] = edges[edges.size() - 1 - n];
    if (mesh.flip(c, d, limits)) return true;
  }
  bool has_moved = false;
  for (const std::uint32_t corner : t) has_moved = spread(mesh, corner, limits) || has_moved;
  if (has_moved || limits.keeps_creases) return has_moved;
  // A spike of three triangles keeps the edges around it from collapsing: without it the next pass may do that.
  for (const std::uint32_t corner : t) {
    if (mesh.fans().of(corner).size() != 3) continue;
    for (const std::uint32_t to : t) {
      if (to != corner && mesh.collapse(corner, to, {.keeps_creases = false})) return true;
    }
  }
  return false;
}

}  // namespace

void collapse_edges(const FineSurface& fine, PassedVertices& next, CollapsedPart& part,
                    const std::vector<std::uint8_t>& is_kept) {
  constexpr double kSoundCosine = 0.98;  // 11.5 degrees
  EdgeCollapser mesh(fine, next, part, is_kept);
  CollapseQueue(mesh).run({.angle_cosine = kSoundCosine});
  part = mesh.part();
}

std::vector<Eigen::Vector3f> widen_angles(const FineSurface& fine, PassedVertices& next, CollapsedPart& part,
                                          double wanted_rad) {
  constexpr int kPasses = 24;
  const double wanted_cosine = std::cos(wanted_rad);
  EdgeCollapser mesh(fine, next, part, std::vector<std::uint8_t>(part.originals.size(), 0));
  EdgeCollapser::Limits limits{.angle_cosine = wanted_cosine, .gain = kGain};
  for (int pass = 0; pass < kPasses; ++pass) {
    bool is_thin = false, is_changed = false;
    for (std::uint32_t triangle = 0; triangle < mesh.triangle_count(); ++triangle) {
      if (mesh.is_dead(triangle) || mesh.angle_cosine(triangle) <= wanted_cosine) continue;
      is_thin = true;
      is_changed = widen(mesh, triangle, limits) || is_changed;
    }
    if (!is_thin || (!is_changed && !limits.keeps_creases)) break;
    if (!is_changed) limits.keeps_creases = false;
  }
  part = mesh.part();
  return mesh.positions_mm();
}

}  // namespace spinaltap::detail
