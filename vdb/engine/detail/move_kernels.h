#pragma once

#include <cstddef>
#include <vector>

namespace spinaltap::detail {

/// A line of a bit's axis as certificates hold it, and what checks need beside: see MoveCertificates.
struct MoveLine {
  float axis_x, axis_y, axis_z;
  float foot_x, foot_y, foot_z, turn_x, turn_y, turn_z, back;
  float turned, half, edge, way;
  float noise, back_noise;  ///< what rounding may hide, mm: of feet, and of places along the axis
};

/// So many boxes are checked together: columns have room for as many past their last.
inline constexpr std::size_t kMoveBlock = 16;

/// Certificates of boxes, a column a number.
struct MoveColumns {
  const float *x, *y, *z, *foot_x, *foot_y, *foot_z, *turn_x, *turn_y, *turn_z, *back, *free, *forward, *backward,
      *side_x, *side_y, *side_z, *sine, *axial, *rest;
};

/// One set of instructions. All sets do the same operations in the same order: their results are the same bits.
struct MoveKernels {
  const char* name;
  /// left[i] = what is left of the certificate of box begin + i, for `count` of them.
  void (*check)(const MoveColumns& columns, const MoveLine& at, std::size_t begin, std::size_t count, float* left);

  // Of machines that are no x86 the first alone.
  static MoveKernels portable();
  static MoveKernels avx2();
  static MoveKernels avx512();
};

/// The sets that this machine can run; portable ones first, the fastest last.
const std::vector<MoveKernels>& move_kernels();

}  // namespace spinaltap::detail
