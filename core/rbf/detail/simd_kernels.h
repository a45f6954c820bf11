#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace spinaltap::detail {

/// Numbers that the kernels take at once. The same on every CPU, so that sums run in the same order everywhere.
inline constexpr std::size_t kLanes = 8;
/// Nodes along a box's edge: even grids of more magnify rounding faster than they gain accuracy.
inline constexpr int kMaxOrder = 12;

/// Sources as arrays, one a coordinate.
struct SourceArrays {
  const double* x = nullptr;
  const double* y = nullptr;
  const double* z = nullptr;
  const double* weight = nullptr;
};

/// Eight sums, and their gradients where they are wanted: value[8], d/dx[8], d/dy[8], d/dz[8].
struct LaneSums {
  double value[kLanes];
  double gradient[3][kLanes];
};

/// A pair of spectra that one box's far field is made of: indices of a table entry and of a source box.
struct SpectrumPair {
  std::uint32_t table;
  std::uint32_t source;
};

/// The loops where the time goes, compiled once for each instruction set. All of them round alike and give the same
/// bits: IEEE square roots and quotients, no fused multiply-add, one order of summation.
struct SimdKernels {
  const char* name;

  /// Adds sum_j w_j (|t - y_j|^2 + c2)^(power/2) over sources [begin, end) for eight targets (x[8], y[8], z[8]);
  /// power is 1 or 3. A source at a target has no gradient there and adds none.
  void (*near_sum)(int power, bool gradient, const double* targets, const SourceArrays& sources, std::size_t begin,
                   std::size_t end, double c2, LaneSums& sums);

  /// Values and, where wanted, gradients (per unit of the box's half width) at eight places (-1..1, x[8], y[8], z[8])
  /// of the polynomial through `nodes` (order^3 numbers, x fastest) on an even grid over the box; adds to `sums`.
  /// `inverse` are the reciprocals of each basis polynomial's product at its own node.
  void (*interpolate)(int order, bool gradient, const double* places, const double* nodes, const double* inverse,
                      double scale, LaneSums& sums);

  /// The same polynomial's values on a lattice of counts[0] x counts[1] x counts[2] places; `places` are the axes'
  /// coordinates (-1..1), each list filled up to a multiple of kLanes. Writes rows of counts[0] values, filled up to
  /// such a multiple: out[(k * counts[1] + j) * row + i], the bits that interpolate() adds at each place. `work` holds
  /// `order` numbers for each y and z of the filled lists.
  void (*interpolate_lattice)(int order, const std::size_t* counts, const double* const* places, const double* nodes,
                              const double* inverse, double* work, double* out);

  /// out = sum over pairs of table[pair.table] * source[pair.source], complex numbers in chunks of eight: re[8] im[8].
  void (*multiply_spectra)(const SpectrumPair* pairs, std::size_t count, const double* table, const double* source,
                           double* out);

  /// out[r * columns + c] = sum_k (a_re + i a_im)[r * inner + k] * (in_re + i in_im)[k * columns + c]; `columns` is a
  /// multiple of kLanes.
  void (*multiply_complex)(std::size_t rows, std::size_t inner, std::size_t columns, const double* a_re,
                           const double* a_im, const double* in_re, const double* in_im, double* out_re,
                           double* out_im);

  /// Eight local systems at once, each of `count` points (points[(3 i + axis) * kLanes + lane], within about 1 of each
  /// other): the column L'^-1 e_last, where L L' = -+phi + diagonal + a penalty on polynomials of `terms` terms. That
  /// is the last point's cardinal function, scaled to 1 in the kernel's norm. `work` holds
  /// (terms * count + count (count + 1) / 2) * kLanes numbers.
  void (*local_functions)(int power, std::size_t count, std::size_t terms, const double* points, const double* diagonal,
                          double* work, double* out);

  // Of machines that are no x86 the first alone.
  static SimdKernels portable();
  static SimdKernels avx2();
  static SimdKernels avx512();
};

/// The kernels that this CPU can run, portable ones first, the fastest last.
const std::vector<SimdKernels>& simd_kernels();

/// The fastest of them.
const SimdKernels& best_simd_kernels();

}  // namespace spinaltap::detail
