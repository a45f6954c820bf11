#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/triangle_mesh.h"

namespace spinaltap::detail {

/// Finds the triangles near a place: a uniform grid whose cells list the triangles with a box that meets them.
class TriangleGrid {
 public:
  /// `mesh` must outlive the grid. Throws Error on an index out of range or a vertex that is not finite.
  explicit TriangleGrid(const TriangleMesh& mesh);

  struct Cell {
    Eigen::Array3i at;
    std::span<const std::uint32_t> triangles;  ///< ascending
  };
  std::size_t cell_count() const { return first_.size() - 1; }
  Cell cell(std::size_t index) const;
  Eigen::Array3i cell_of(const Vec3& p_mm) const;
  const Box3& box_of(std::size_t triangle) const { return boxes_[triangle]; }
  Vec3 corner(std::size_t triangle, std::size_t c) const {
    return mesh_.vertices_mm[mesh_.triangles[triangle][c]].cast<double>();
  }
  const TriangleMesh& mesh() const { return mesh_; }

  /// Distance (mm) from p to the nearest triangle.
  double distance_mm(const Vec3& p_mm) const;
  /// Whether a triangle is that near to p; quicker.
  bool is_within(const Vec3& p_mm, double distance_mm) const;

 private:
  std::size_t index_of(const Eigen::Array3i& cell) const {
    return (static_cast<std::size_t>(cell.z()) * static_cast<std::size_t>(cells_.y()) +
            static_cast<std::size_t>(cell.y())) *
               static_cast<std::size_t>(cells_.x()) +
           static_cast<std::size_t>(cell.x());
  }

  const TriangleMesh& mesh_;
  std::vector<Box3> boxes_;
  Box3 box_;
  double cell_mm_ = 1.0;
  Eigen::Array3i cells_ = Eigen::Array3i::Ones();
  std::vector<std::uint32_t> first_;
  std::vector<std::uint32_t> listed_;
};

}  // namespace spinaltap::detail
