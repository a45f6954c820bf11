#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "core/base/geometry.h"
#include "core/rbf/detail/far_field.h"
#include "core/rbf/detail/lagrange_grid.h"
#include "core/rbf/detail/octree.h"

namespace spinaltap::detail {

struct FastSumOptions {
  int order = 7;                ///< nodes along a box's edge; each more gives about half a digit
  std::size_t leaf_size = 128;  ///< most centres of a box that is not divided
  bool anywhere = true;         ///< false: only at_centres() is wanted
  /// A box that touches one with more centres than this is divided as it is: places far from centres cost less then,
  /// and what is made beforehand more. None: only boxes with too many centres of their own.
  std::size_t beside_size = Octree::kNone;
  const SimdKernels* simd = nullptr;  ///< null: the fastest here
};

/// The sums themselves, term by term; `gradients` may be empty.
void direct_sums(RadialKernel kernel, double low_pass_mm, std::span<const Vec3> centres_mm,
                 std::span<const double> weights, std::span<const Vec3> points_mm, std::span<double> values,
                 std::span<Vec3> gradients, const SimdKernels& simd = best_simd_kernels());

/// Coordinates along x, y and z.
using LatticeAxes = std::array<std::span<const double>, 3>;

/// Sums sum_j w_j phi(|x - c_j|) and their gradients at many places: a fast multipole method that interpolates the
/// kernel on even grids in the boxes of an octree (kernel-independent, so that phi may be low-pass filtered; Fong &
/// Darve 2009) and goes from box to box by Fourier transforms (Blanchard, Coulaud & Darve 2015). A place's result
/// depends on the place alone, not on what else is asked for in the same call, and not on the number of threads.
class FastSum {
 public:
  FastSum(RadialKernel kernel, double low_pass_mm, std::span<const Vec3> centres_mm, const FastSumOptions& options);

  /// One weight a centre, in the centres' order.
  void set_weights(std::span<const double> weights);

  /// The sums at the centres themselves.
  void at_centres(std::span<double> values) const;

  /// The sums anywhere; `gradients` may be empty. Safe to call from many threads at once. Where gradients are not
  /// wanted and the points are those of a lattice along the axes, x fastest, its boxes are done as a whole.
  void evaluate(std::span<const Vec3> points_mm, std::span<double> values, std::span<Vec3> gradients) const;

  /// The sums at all places with one of each axis' coordinates, x fastest, with the bits of evaluate(); each list
  /// grows.
  void evaluate_lattice(const LatticeAxes& axes_mm, std::span<double> values) const;

 private:
  /// The places of a lattice in one leaf: [begin, end) along each axis.
  struct LatticePart {
    std::uint32_t leaf;
    std::array<std::size_t, 3> begin;
    std::array<std::size_t, 3> end;
  };
  void evaluate_each(std::span<const Vec3> points_mm, std::span<double> values, std::span<Vec3> gradients) const;
  void divide_lattice(const LatticeAxes& axes_mm, const LatticePart& part, std::vector<LatticePart>& parts) const;
  void lattice_sums(const LatticeAxes& axes_mm, const LatticePart& part, std::span<double> values) const;
  void spread_weights();
  void translate();
  void pass_down();
  void leaf_sums(std::uint32_t leaf, const double* targets, bool gradient, LaneSums& sums) const;
  /// What leaf_sums() adds to the leaf's own polynomial.
  void beside_sums(std::uint32_t leaf, const double* targets, bool gradient, LaneSums& sums) const;
  void outside_sums(std::uint32_t box, const double* targets, const Vec3& p_mm, bool gradient, LaneSums& sums) const;
  /// Adds the sums over a box's nodes, taken as sources.
  void expansion_sums(std::uint32_t box, const double* targets, bool gradient, LaneSums& sums) const;
  void near_sums(SourceRange range, const double* targets, bool gradient, LaneSums& sums) const;

  RadialKernel kernel_;
  double c2_;
  FastSumOptions options_;
  const SimdKernels& simd_;
  LagrangeGrid grid_;
  Octree tree_;
  InteractionLists lists_;
  FarField far_field_;
  std::vector<std::uint32_t> multipole_slot_;  ///< of each box with sources
  std::vector<std::uint32_t> local_slot_;      ///< of each box with targets
  std::vector<double> x_mm_;                   ///< the centres in the tree's order
  std::vector<double> y_mm_;
  std::vector<double> z_mm_;
  std::vector<double> weight_;
  std::vector<double> multipole_;
  std::vector<double> local_;
};

}  // namespace spinaltap::detail
