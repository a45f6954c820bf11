#include "mesh/detail/sizing_field.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <queue>
#include <utility>

namespace spinaltap::detail {
namespace {

/// Largest absolute principal curvature (1/mm) at p: the shape operator that best tells the neighbours' normals
/// (least squares in the tangent plane). Squared distances weigh, so that a neighbour very near, whose normal tells
/// nothing, does no harm.
double largest_curvature(const Vec3& p_mm, const Vec3& normal, std::span<const std::uint32_t> neighbours,
                         std::span<const Vec3> points_mm, std::span<const Vec3> normals) {
  const Vec3 u = any_perpendicular(normal);
  const Vec3 v = normal.cross(u);
  // Unknowns: the operator's entries uu, uv, vv.
  Mat3 matrix = Mat3::Zero();
  Vec3 right = Vec3::Zero();
  for (const std::uint32_t n : neighbours) {
    const Vec3 way = points_mm[n] - p_mm;
    const Vec3 turn = normals[n] - normal;
    const Vec3 row_u(way.dot(u), way.dot(v), 0.0);
    const Vec3 row_v(0.0, way.dot(u), way.dot(v));
    matrix += row_u * row_u.transpose() + row_v * row_v.transpose();
    right += turn.dot(u) * row_u + turn.dot(v) * row_v;
  }
  const double scale = matrix.trace();
  if (!(scale > 0.0)) return 0.0;
  // Neighbours in one line tell nothing across it: a little damping keeps that 0.
  matrix.diagonal().array() += 1e-6 * scale;
  const Vec3 s = matrix.inverse() * right;
  const double mean = 0.5 * (s[0] + s[2]);
  return std::abs(mean) + std::hypot(0.5 * (s[0] - s[2]), s[1]);
}

}  // namespace

SizingField::SizingField(std::vector<Vec3> points_mm, std::span<const Vec3> normals,
                         std::span<const std::array<std::uint32_t, 3>> triangles, const SizingLimits& limits)
    : points_mm_(std::move(points_mm)), slope_(limits.slope), longest_mm_(limits.longest_mm) {
  const std::size_t count = points_mm_.size();
  first_.assign(count + 1, 0);
  for (const auto& t : triangles) {
    for (const std::uint32_t corner : t) first_[corner + 1] += 1;
  }
  for (std::size_t i = 0; i < count; ++i) first_[i + 1] += first_[i];
  // On a closed surface the next corner of each triangle around a point names each neighbour once.
  neighbours_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  double length_sum_mm = 0.0;
  for (const auto& t : triangles) {
    for (std::size_t c = 0; c < 3; ++c) {
      neighbours_[next[t[c]]++] = t[(c + 1) % 3];
      length_sum_mm += (points_mm_[t[c]] - points_mm_[t[(c + 1) % 3]]).norm();
    }
  }
  const double mean_edge_mm = length_sum_mm / static_cast<double>(std::max<std::size_t>(1, 3 * triangles.size()));
  reach_mm_ = 1.5 * mean_edge_mm;

  length_mm_.assign(count, 0.0);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    const std::span<const std::uint32_t> around(neighbours_.data() + first_[i], first_[i + 1] - first_[i]);
    const double k = largest_curvature(points_mm_[i], normals[i], around, points_mm_, normals);
    const double e = limits.error_mm;
    const double length_squared = 6.0 * e / std::max(k, 1e-9) - 3.0 * e * e;
    length_mm_[i] = std::clamp(std::sqrt(std::max(length_squared, 0.0)), limits.shortest_mm, limits.longest_mm);
  });
  even_out();
  grid_ = std::make_unique<PointGrid>(points_mm_, std::max(mean_edge_mm, 1e-6));
}

double SizingField::at(const Vec3& p_mm) const {
  // The point itself is within reach mostly; a third of it has a tenth of the cells.
  for (double radius_mm = reach_mm_ / 3.0;; radius_mm *= 2.0) {
    const PointGrid::Nearest nearest = grid_->nearest_within(p_mm, radius_mm);
    if (nearest.distance_mm <= radius_mm) return length_mm_[nearest.index];
    if (!(radius_mm < 1e3 * longest_mm_)) return longest_mm_;
  }
}

void SizingField::refine(std::span<const Cap> caps) {
  for (const Cap& cap : caps) {
    const double radius_mm = std::max(cap.radius_mm, reach_mm_);
    grid_->for_each_within(cap.place_mm, radius_mm,
                           [&](std::size_t i) { length_mm_[i] = std::min(length_mm_[i], cap.length_mm); });
  }
  even_out();
}

void SizingField::even_out() {
  // Dijkstra from all points at once: the shortest lengths spread to their neighbours first.
  using Entry = std::pair<double, std::uint32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  const auto spread_from = [&](std::uint32_t i) {
    for (std::uint32_t at = first_[i]; at < first_[i + 1]; ++at) {
      const std::uint32_t n = neighbours_[at];
      const double max_mm = length_mm_[i] + slope_ * (points_mm_[n] - points_mm_[i]).norm();
      if (max_mm < length_mm_[n]) {
        length_mm_[n] = max_mm;
        open.emplace(max_mm, n);
      }
    }
  };
  for (std::uint32_t i = 0; i < points_mm_.size(); ++i) spread_from(i);
  while (!open.empty()) {
    const auto [length_mm, i] = open.top();
    open.pop();
    if (length_mm <= length_mm_[i]) spread_from(i);
  }
}

}  // namespace spinaltap::detail
