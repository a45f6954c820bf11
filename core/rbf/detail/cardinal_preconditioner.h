#pragma once

#include <span>
#include <vector>

#include "core/rbf/detail/coarse_to_fine.h"
#include "core/rbf/detail/simd_kernels.h"
#include "core/rbf/rbf_model.h"

namespace spinaltap::detail {

/// An approximate inverse of the interpolation matrix, sparse and symmetric: sum_k psi_k psi_k', where psi_k is the
/// cardinal function of the k-th point of a coarse-to-fine order, over its nearest points before it. With all points
/// before it the sum would be the exact inverse on weights that the side conditions allow; with a few it is nearly so,
/// because the fields of finer points are screened by the coarser ones around them.
/// Sources: Faul, Goodsell & Powell 2005 (the functions); Schaefer, Katzfuss & Owhadi 2021 (the order, and why).
class CardinalPreconditioner {
 public:
  /// `smoothing_mm`: one a point, what is added to the matrix's diagonal.
  CardinalPreconditioner(RadialKernel kernel, std::span<const Vec3> points_mm, std::span<const double> smoothing_mm,
                         CoarseToFine order, const SimdKernels& simd);

  /// out = about the inverse times `in`, one a point. The side conditions hold but for rounding in float.
  void apply(std::span<const double> in, std::span<double> out) const;

 private:
  std::size_t terms_;
  double sign_;
  CoarseToFine order_;
  std::vector<float> function_;  ///< of the k-th point: its neighbours' weights, then its own, at k * (neighbours + 1)
};

}  // namespace spinaltap::detail
