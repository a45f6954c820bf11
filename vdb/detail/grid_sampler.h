#pragma once

#include <cstdint>
#include <span>

#include "core/base/geometry.h"
#include "vdb/detail/block_table.h"
#include "vdb/detail/index_map.h"

namespace spinaltap::detail {

/// Samples one grid of floats, from any number of threads at once. The grid must outlive it. Beyond the grid's content,
/// and at positions that are not numbers, it finds the background value and no slope. All spans of a call have one
/// length; `gradients` (per mm, patient LPS) may be empty instead.
class GridSampler {
 public:
  GridSampler(BlockTable table, const IndexMap& map);

  /// Tri-linear: OpenVDB's BoxSampler, bit for bit. The gradient is the interpolant's own: it jumps from cell to cell.
  void linear(std::span<const Vec3> points_mm, std::span<float> values, std::span<Vec3> gradients) const;

  /// Tri-quadratic: along each axis the parabola through the nearest voxel and its two neighbours. Exact for
  /// quadratics; half-way between voxels value and gradient jump by terms of third order. (OpenVDB's QuadraticSampler
  /// puts the parabola on the voxel below instead: no jump in the value, but twice the largest error of the slope,
  /// eight times half-way.)
  void quadratic(std::span<const Vec3> points_mm, std::span<float> values, std::span<Vec3> gradients) const;
  void quadratic(std::span<const Vec3> points_mm, std::span<double> values, std::span<Vec3> gradients) const;

  /// 1 where the tri-linear value is negative, 0 elsewhere. Needs the table's signs.
  void negative(std::span<const Vec3> points_mm, std::span<std::uint8_t> result) const;

 private:
  struct Stencil;
  struct Batch;

  template <unsigned Size, class Even>
  void locate(std::span<const Vec3> points_mm, Batch& batch, const Even& even) const;
  template <unsigned Size>
  void prefetch_values(const Batch& batch) const;
  template <class Value>
  void quadratic_of(std::span<const Vec3> points_mm, std::span<Value> values, std::span<Vec3> gradients) const;
  /// Whether every stencil around the index lies in the table.
  bool holds(const Vec3& p_index) const;

  BlockTable table_;
  IndexMap map_;
  Vec3 low_index_ = Vec3::Zero();
  Vec3 end_index_ = Vec3::Zero();
};

}  // namespace spinaltap::detail
