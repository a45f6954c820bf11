#include "core/base/point_grid.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"

namespace spinaltap {

PointGrid::PointGrid(std::span<const Vec3> points_mm, double cell_mm) : points_mm_(points_mm), cell_mm_(cell_mm) {
  // More cells than this would cost more to make than they save.
  const double max_cells = std::clamp(64.0 * static_cast<double>(points_mm.size()), 4096.0, 0x1.0p24);
  if (!(cell_mm > 0.0)) fail("point grid: expected cells above 0 mm, found ", cell_mm);
  if (points_mm.size() >= std::numeric_limits<std::uint32_t>::max()) fail("point grid: too many points");
  Box3 box;
  for (const Vec3& p : points_mm) {
    if (!p.allFinite()) fail("point grid: a position is not a number");
    box.extend(p);
  }
  if (points_mm.empty()) box.extend(Vec3::Zero());
  low_mm_ = box.min();
  const Vec3 extent_mm = box.sizes();
  // Far outliers would ask for more cells than there is memory: larger cells stay right, only slower.
  while (
      (extent_mm / cell_mm_).array().floor().cwiseMax(0.0).matrix().unaryExpr([](double n) { return n + 1.0; }).prod() >
      max_cells) {
    cell_mm_ *= 2.0;
  }
  cells_ = (extent_mm / cell_mm_).array().floor().cast<int>() + 1;
  const std::size_t cell_count = cell_index(cells_.x() - 1, cells_.y() - 1, cells_.z() - 1) + 1;
  cell_start_.assign(cell_count + 1, 0);
  const auto cell_of_point = [&](const Vec3& p) {
    const Eigen::Array3i cell = cell_of(p);
    return cell_index(cell.x(), cell.y(), cell.z());
  };
  for (const Vec3& p : points_mm) ++cell_start_[cell_of_point(p) + 1];
  for (std::size_t cell = 0; cell < cell_count; ++cell) cell_start_[cell + 1] += cell_start_[cell];
  order_.resize(points_mm.size());
  std::vector<std::uint32_t> next(cell_start_.begin(), cell_start_.end() - 1);
  for (std::uint32_t i = 0; i < points_mm.size(); ++i) order_[next[cell_of_point(points_mm[i])]++] = i;
}

Eigen::Array3i PointGrid::cell_of(const Vec3& p_mm) const {
  const Eigen::Array3d cell = ((p_mm - low_mm_) / cell_mm_).array().floor();
  return cell.max(0.0).min((cells_ - 1).cast<double>()).cast<int>();
}

PointGrid::Nearest PointGrid::nearest_within(const Vec3& p_mm, double radius_mm) const {
  Nearest nearest;
  for_each_within(p_mm, radius_mm, [&](std::size_t index) {
    const double squared_mm2 = (points_mm_[index] - p_mm).squaredNorm();
    // No root for those that are further in any case.
    if (squared_mm2 > 1.000001 * nearest.distance_mm * nearest.distance_mm) return;
    const double distance_mm = std::sqrt(squared_mm2);
    if (distance_mm < nearest.distance_mm || (distance_mm == nearest.distance_mm && index < nearest.index)) {
      nearest = {index, distance_mm};
    }
  });
  return nearest;
}

std::vector<std::size_t> spread_subset(std::span<const Vec3> points_mm, std::span<const Vec3> normals,
                                       double spacing_mm) {
  constexpr double kSameSide = 0.5;  // cosine
  const PointGrid grid(points_mm, spacing_mm);
  std::vector<bool> covered(points_mm.size(), false);
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < points_mm.size(); ++i) {
    if (covered[i]) continue;
    kept.push_back(i);
    covered[i] = true;
    grid.for_each_within(points_mm[i], spacing_mm, [&](std::size_t index) {
      if (normals[index].dot(normals[i]) > kSameSide) covered[index] = true;
    });
  }
  return kept;
}

}  // namespace spinaltap
