#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/geometry.h"
#include "core/base/random.h"

namespace spinaltap::detail {

/// Finds points near a place: a hash of cells, for points that are added one by one and that fill little of their box.
class SparseGrid {
 public:
  /// Room for `capacity` points. `points_mm` must outlive the grid.
  SparseGrid(std::span<const Vec3> points_mm, double cell_mm, std::size_t capacity)
      : points_mm_(points_mm), cell_mm_(cell_mm) {
    std::size_t size = 64;
    while (size < 2 * capacity) size *= 2;
    heads_.assign(size, kEmpty);
    next_.reserve(capacity);
    index_.reserve(capacity);
  }

  double cell_mm() const { return cell_mm_; }
  /// Points for each slot in use: about those of a cell, where there are any.
  double mean_occupancy() const { return static_cast<double>(index_.size()) / static_cast<double>(used_); }

  void add(std::uint32_t index) {
    const Cell cell = cell_of(points_mm_[index]);
    std::uint32_t& head = heads_[slot(cell.x, cell.y, cell.z)];
    used_ += head == kEmpty ? 1 : 0;
    next_.push_back(head);
    index_.push_back(index);
    head = static_cast<std::uint32_t>(index_.size() - 1);
  }

  /// Calls visit(index, squared distance) for the points within `radius_mm`, in an order that depends on the points and
  /// the order of adding alone. Stops when it returns true, and says whether it did.
  template <class Visit>
  bool visit_within(const Vec3& p_mm, double radius_mm, const Visit& visit) const {
    const double radius2 = radius_mm * radius_mm;
    // Where the radius holds more cells than there are points, it is quicker to look at all points.
    const double max_cells = std::pow(2.0 * radius_mm / cell_mm_ + 1.0, 3);
    if (max_cells > static_cast<double>(index_.size()) + kFewCells) {
      for (const std::uint32_t index : index_) {
        const double d2 = (points_mm_[index] - p_mm).squaredNorm();
        if (d2 <= radius2 && visit(index, d2)) return true;
      }
      return false;
    }
    const Cell low = cell_of(p_mm - Vec3::Constant(radius_mm));
    const Cell high = cell_of(p_mm + Vec3::Constant(radius_mm));
    for (std::int64_t z = low.z; z <= high.z; ++z) {
      for (std::int64_t y = low.y; y <= high.y; ++y) {
        for (std::int64_t x = low.x; x <= high.x; ++x) {
          for (std::uint32_t at = heads_[slot(x, y, z)]; at != kEmpty; at = next_[at]) {
            const Vec3& q = points_mm_[index_[at]];
            const double d2 = (q - p_mm).squaredNorm();
            if (!(d2 <= radius2)) continue;
            // Cells that share a slot are told apart, so that no point is met twice.
            const Cell cell = cell_of(q);
            if (cell.x != x || cell.y != y || cell.z != z) continue;
            if (visit(index_[at], d2)) return true;
          }
        }
      }
    }
    return false;
  }

 private:
  static constexpr std::uint32_t kEmpty = 0xffffffffU;
  static constexpr double kFewCells = 1000.0;
  struct Cell {
    std::int64_t x;
    std::int64_t y;
    std::int64_t z;
  };
  Cell cell_of(const Vec3& p_mm) const {
    const Vec3 cell = (p_mm / cell_mm_).array().floor();
    return {static_cast<std::int64_t>(cell.x()), static_cast<std::int64_t>(cell.y()),
            static_cast<std::int64_t>(cell.z())};
  }
  std::size_t slot(std::int64_t x, std::int64_t y, std::int64_t z) const {
    const auto mixed = mix_bits(static_cast<std::uint64_t>(x) * 0x9e3779b97f4a7c15ULL ^
                                static_cast<std::uint64_t>(y) * 0xc2b2ae3d27d4eb4fULL ^
                                static_cast<std::uint64_t>(z) * 0x165667b19e3779f9ULL);
    return mixed & (heads_.size() - 1);
  }

  std::span<const Vec3> points_mm_;
  double cell_mm_;
  std::size_t used_ = 0;
  std::vector<std::uint32_t> heads_;
  std::vector<std::uint32_t> next_;
  std::vector<std::uint32_t> index_;
};

}  // namespace spinaltap::detail
