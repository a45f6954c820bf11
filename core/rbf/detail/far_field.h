#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/rbf/detail/interaction_lists.h"
#include "core/rbf/detail/simd_kernels.h"
#include "core/rbf/rbf_model.h"

namespace spinaltap::detail {

/// From boxes' nodes to other boxes' nodes of the same level: sums phi over all pairs of nodes. On even grids that is a
/// convolution, so that it is a product of discrete Fourier transforms of 2 * order - 1 points along each axis. The
/// transforms are written as small matrix products: of the input only `order` points are not zero, of the output only
/// `order` are wanted, and for such sizes that beats a general transform.
class FarField {
 public:
  FarField(RadialKernel kernel, double c2, int order, const SimdKernels& simd);

  /// Adds to `local` (node_count numbers a box) what `multipole` of the boxes in `lists.far` does to the boxes
  /// [begin, end), which are those of one level; `slot` is each box's place in `multipole` and `local`.
  void translate(const Octree& tree, const InteractionLists& lists, std::uint32_t begin, std::uint32_t end,
                 const std::vector<std::uint32_t>& multipole_slot, const std::vector<double>& multipole,
                 const std::vector<std::uint32_t>& local_slot, std::vector<double>& local);

 private:
  /// The kernel's spectra for all offsets between boxes of half width `half_mm`; kept until another size is asked for.
  void prepare_table(double half_mm);
  /// Spectrum of one box's nodes; `chunks` numbers of stride `stride` apart.
  void transform(const double* nodes, double* spectrum, std::size_t stride) const;
  /// Writes rows of complex numbers, padded as the transforms leave them, as chunks `stride` apart.
  void store(const double* re, const double* im, double* spectrum, std::size_t stride) const;
  void transform_back(const double* spectrum, std::size_t stride, double* nodes) const;

  RadialKernel kernel_;
  double c2_;
  std::size_t order_;
  std::size_t length_;  ///< of the transform, 2 order - 1
  std::size_t chunks_;  ///< of a spectrum, eight complex numbers each
  const SimdKernels& simd_;
  std::vector<double> cos_;  ///< cos and sin of -2 pi k m / length, k * length + m
  std::vector<double> sin_;
  std::vector<double> minus_sin_;  ///< of the way back
  std::vector<double> short_cos_;  ///< their first `order` columns, for inputs that are zero beyond
  std::vector<double> short_sin_;
  double table_half_mm_ = 0.0;  ///< box size of table_; the plain kernels need one only, for boxes of half width 1
  std::vector<double> table_;   ///< chunk by chunk, in it offset by offset
  std::vector<double> source_spectra_;  ///< chunk by chunk, in it box by box; kept from call to call
  std::vector<double> target_spectra_;
};

}  // namespace spinaltap::detail
