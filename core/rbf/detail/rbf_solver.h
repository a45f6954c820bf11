#pragma once

#include <Eigen/Core>

#include <memory>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/rbf/detail/cardinal_preconditioner.h"
#include "core/rbf/detail/fast_sum.h"
#include "core/rbf/rbf_model.h"

namespace spinaltap::detail {

struct RbfSolution {
  RbfModel model;
  int iterations = 0;
  double max_residual_mm = 0.0;  ///< of the equations at all centres, as the fast sums tell it
  double sum_error_mm = 0.0;     ///< what those sums may be wrong by
};

/// Solves [A + S  P; P' 0] [w; a] = [f; 0], A_ij = phi(|x_i - x_j|), S what smoothing adds to the diagonal, for one set
/// of points and any number of values f. GMRES (Saad & Schultz 1986), preconditioned from the right by
/// CardinalPreconditioner, in the space that the side conditions P'w = 0 leave, with fast sums for A.
class RbfSolver {
 public:
  /// Points must be finite and differ; `smoothing_mm` is empty or has one number a point. Throws Error when the points
  /// do not determine the polynomial.
  RbfSolver(RadialKernel kernel, std::vector<Vec3> points_mm, std::vector<double> smoothing_mm = {});

  /// Solves to `accuracy_mm` at every point, starting from `start` (weights; empty: from nothing). Throws Error when
  /// that accuracy cannot be reached, Cancelled.
  RbfSolution solve(std::span<const double> values_mm, double accuracy_mm, std::span<const double> start = {},
                    const Progress& progress = {});

  const std::vector<Vec3>& points_mm() const { return points_mm_; }

 private:
  using Vector = Eigen::VectorXd;

  /// (A + S) w.
  Vector multiply(const Vector& weights);
  /// Takes the polynomial part out.
  void project(Vector& vector) const;
  void use_order(int order);
  /// Takes the lowest order, from the present one up, whose sums of these weights are accurate enough; beyond the
  /// highest, sums term by term. Returns the matrix times the weights.
  Vector choose_order(const Vector& weights, double accuracy_mm);
  /// Largest difference between fast and direct sums at some points, for the weights last multiplied.
  double sum_error(const Vector& weights, const Vector& product) const;
  /// Improves the weights until the residual's largest entry is below `target_mm`; returns iterations.
  int improve(Vector& weights, Vector& residual, double target_mm, const Progress& progress);

  RadialKernel kernel_;
  std::vector<Vec3> points_mm_;
  std::vector<double> smoothing_mm_;
  Vec3 origin_mm_;
  double extent_mm_;                 ///< scale of the polynomial's coordinates
  Eigen::MatrixXd basis_;            ///< orthonormal columns that span the polynomials at the points
  Eigen::MatrixXd to_coefficients_;  ///< from a vector's products with basis_ to coefficients of monomials in mm
  std::unique_ptr<CardinalPreconditioner> preconditioner_;
  std::unique_ptr<FastSum> sum_;
  int order_ = 0;
};

}  // namespace spinaltap::detail
