#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/geometry.h"
#include "vdb/detail/block_table.h"

namespace spinaltap::detail {

/// From patient positions (LPS, mm) to a grid's indices. Each step rounds as OpenVDB's own maps do, so that both find
/// the same index, bit for bit.
struct IndexMap {
  bool axis_aligned = true;          ///< index = (p - origin_mm) * per_mm; otherwise matrix * p + offset
  Vec3 origin_mm = Vec3::Zero();     ///< centre of voxel (0, 0, 0), patient LPS
  Vec3 per_mm = Vec3::Ones();        ///< indices per mm along each axis
  Mat3 matrix = Mat3::Identity();    ///< indices per mm
  Vec3 offset_index = Vec3::Zero();  ///< index of the patient frame's origin

  Vec3 to_index(const Vec3& p_patient) const {
    if (axis_aligned) return (p_patient - origin_mm).cwiseProduct(per_mm);
    Vec3 p_index;
    for (int axis = 0; axis < 3; ++axis) {
      p_index[axis] = p_patient.x() * matrix(axis, 0) + p_patient.y() * matrix(axis, 1) +
                      p_patient.z() * matrix(axis, 2) + offset_index[axis];
    }
    return p_index;
  }

  /// A slope per index as a slope per mm.
  Vec3 gradient_to_patient(const Vec3& gradient_index) const {
    if (axis_aligned) return gradient_index.cwiseProduct(per_mm);
    return matrix.transpose() * gradient_index;
  }
};

/// A lattice of 8 x 8 x 8 positions along the patient's axes: the coordinates of each axis, rising, mm.
struct LatticeBlock {
  static constexpr std::size_t kSide = 8;
  std::array<std::array<double, kSide>, 3> at_mm;

  /// The n-th position, z fastest.
  Vec3 position_mm(std::size_t n) const { return {at_mm[0][n / 64], at_mm[1][n / 8 % 8], at_mm[2][n % 8]}; }
};

/// Samples one grid of floats, from any number of threads at once. The grid must outlive it. Beyond the grid's content,
/// and at positions that are not numbers, it finds the background value and no slope. All spans of a call have one
/// length; `gradients` (per mm, patient LPS) may be empty instead.
class GridSampler {
 public:
  GridSampler(BlockTable table, const IndexMap& map);

  /// Tri-linear: OpenVDB's BoxSampler, bit for bit. The gradient is the interpolant's own: it jumps from cell to cell.
  void linear(std::span<const Vec3> points_mm, std::span<float> values, std::span<Vec3> gradients) const;

  /// As linear() at a lattice's positions, z fastest, bit for bit and several times as fast.
  void linear(const LatticeBlock& block, std::span<float, 512> values) const;
  /// Whether the lattice's tri-linear values are all negative (-1), none is (1), or that was not found out (0): quick.
  int sign(const LatticeBlock& block) const;

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
  struct Region;

  /// The voxels that a lattice's values come from; false where they do not lie in the table, are many, or lie askew.
  bool find_region(const LatticeBlock& block, Region& region) const;

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
