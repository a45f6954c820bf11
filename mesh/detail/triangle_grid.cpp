#include "mesh/detail/triangle_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "mesh/detail/triangle_shape.h"

namespace spinaltap::detail {

TriangleGrid::TriangleGrid(const TriangleMesh& mesh) : mesh_(mesh) {
  boxes_.reserve(mesh.triangles.size());
  double side_sum_mm = 0.0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    Box3 box;
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t vertex = mesh.triangles[t][c];
      if (vertex >= mesh.vertices_mm.size()) fail("mesh: vertex ", vertex, " of ", mesh.vertices_mm.size());
      if (!mesh.vertices_mm[vertex].allFinite()) fail("mesh: the position of vertex ", vertex, " is not a number");
      box.extend(corner(t, c));
    }
    boxes_.push_back(box);
    box_.extend(box);
    side_sum_mm += box.sizes().maxCoeff();
  }
  if (boxes_.empty()) box_.extend(Vec3::Zero());
  cell_mm_ = std::max(side_sum_mm / static_cast<double>(std::max<std::size_t>(1, boxes_.size())), 1e-9);
  // More cells than this would cost more to make than they save.
  const double max_cells = std::clamp(32.0 * static_cast<double>(boxes_.size()), 4096.0, 0x1.0p24);
  while (((box_.sizes() / cell_mm_).array().floor() + 1.0).prod() > max_cells) cell_mm_ *= 1.5;
  cells_ = (box_.sizes() / cell_mm_).array().floor().cast<int>() + 1;

  const auto for_each_cell = [&](const Box3& box, const auto& visit) {
    const Eigen::Array3i low = cell_of(box.min());
    const Eigen::Array3i high = cell_of(box.max());
    Eigen::Array3i at;
    for (at.z() = low.z(); at.z() <= high.z(); ++at.z()) {
      for (at.y() = low.y(); at.y() <= high.y(); ++at.y()) {
        for (at.x() = low.x(); at.x() <= high.x(); ++at.x()) visit(index_of(at));
      }
    }
  };
  first_.assign(index_of(cells_ - 1) + 2, 0);
  for (const Box3& box : boxes_) for_each_cell(box, [&](std::size_t cell) { ++first_[cell + 1]; });
  for (std::size_t cell = 0; cell + 1 < first_.size(); ++cell) first_[cell + 1] += first_[cell];
  listed_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::uint32_t t = 0; t < boxes_.size(); ++t) {
    for_each_cell(boxes_[t], [&](std::size_t cell) { listed_[next[cell]++] = t; });
  }
}

Eigen::Array3i TriangleGrid::cell_of(const Vec3& p_mm) const {
  const Eigen::Array3d cell = ((p_mm - box_.min()) / cell_mm_).array().floor();
  return cell.max(0.0).min((cells_ - 1).cast<double>()).cast<int>();
}

TriangleGrid::Cell TriangleGrid::cell(std::size_t index) const {
  const auto nx = static_cast<std::size_t>(cells_.x());
  const auto ny = static_cast<std::size_t>(cells_.y());
  const Eigen::Array3i at(static_cast<int>(index % nx), static_cast<int>(index / nx % ny),
                          static_cast<int>(index / nx / ny));
  return {at, std::span(listed_).subspan(first_[index], first_[index + 1] - first_[index])};
}

double TriangleGrid::distance_mm(const Vec3& p_mm) const {
  double nearest_squared = std::numeric_limits<double>::infinity();
  if (boxes_.empty()) return nearest_squared;
  for (double radius_mm = 0.25 * cell_mm_;; radius_mm *= 2.0) {
    const Eigen::Array3i low = cell_of(p_mm - Vec3::Constant(radius_mm));
    const Eigen::Array3i high = cell_of(p_mm + Vec3::Constant(radius_mm));
    Eigen::Array3i at;
    for (at.z() = low.z(); at.z() <= high.z(); ++at.z()) {
      for (at.y() = low.y(); at.y() <= high.y(); ++at.y()) {
        for (at.x() = low.x(); at.x() <= high.x(); ++at.x()) {
          const std::size_t cell = index_of(at);
          for (std::uint32_t i = first_[cell]; i < first_[cell + 1]; ++i) {
            const std::uint32_t t = listed_[i];
            if (boxes_[t].squaredExteriorDistance(p_mm) >= nearest_squared) continue;
            nearest_squared =
                std::min(nearest_squared, squared_distance(p_mm, corner(t, 0), corner(t, 1), corner(t, 2)));
          }
        }
      }
    }
    const bool whole = (low == 0).all() && (high == cells_ - 1).all();
    if (nearest_squared <= radius_mm * radius_mm || whole) return std::sqrt(nearest_squared);
  }
}

bool TriangleGrid::is_within(const Vec3& p_mm, double distance_mm) const {
  if (boxes_.empty()) return false;
  const double squared = distance_mm * distance_mm;
  const Eigen::Array3i low = cell_of(p_mm - Vec3::Constant(distance_mm));
  const Eigen::Array3i high = cell_of(p_mm + Vec3::Constant(distance_mm));
  Eigen::Array3i at;
  for (at.z() = low.z(); at.z() <= high.z(); ++at.z()) {
    for (at.y() = low.y(); at.y() <= high.y(); ++at.y()) {
      for (at.x() = low.x(); at.x() <= high.x(); ++at.x()) {
        const std::size_t cell = index_of(at);
        for (std::uint32_t i = first_[cell]; i < first_[cell + 1]; ++i) {
          const std::uint32_t t = listed_[i];
          if (boxes_[t].squaredExteriorDistance(p_mm) > squared) continue;
          if (squared_distance(p_mm, corner(t, 0), corner(t, 1), corner(t, 2)) <= squared) return true;
        }
      }
    }
  }
  return false;
}

}  // namespace spinaltap::detail
