#pragma once

#include <Eigen/Dense>

#include "core/rbf/detail/polynomial.h"
#include "core/rbf/rbf_model.h"

namespace spinaltap::test {

/// The interpolation matrix [A + S, P; P', 0] with the polynomial around `origin_mm`; `scale_mm` is its unit of length.
/// Smoothing is taken from the diagonal of the biharmonic kernel, which is negative there, and added to the other's.
inline Eigen::MatrixXd dense_matrix(RadialKernel kernel, const std::vector<Vec3>& points_mm, double smoothing_mm,
                                    const Vec3& origin_mm, double scale_mm) {
  const auto count = static_cast<Eigen::Index>(points_mm.size());
  const auto terms = static_cast<Eigen::Index>(polynomial_terms(kernel));
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(count + terms, count + terms);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Vec3& p = points_mm[static_cast<std::size_t>(i)];
    const auto row = polynomial_row(kernel, (p - origin_mm) / scale_mm);
    for (Eigen::Index k = 0; k < terms; ++k) {
      matrix(i, count + k) = matrix(count + k, i) = row[static_cast<std::size_t>(k)];
    }
    for (Eigen::Index j = 0; j < count; ++j) {
      const double r = (p - points_mm[static_cast<std::size_t>(j)]).norm();
      matrix(i, j) = kernel == RadialKernel::biharmonic ? r : r * r * r;
    }
    matrix(i, i) += kernel == RadialKernel::biharmonic ? -smoothing_mm : smoothing_mm;
  }
  return matrix;
}

/// The interpolant by a dense LU factorization.
inline RbfModel dense_solution(RadialKernel kernel, const std::vector<Vec3>& points_mm,
                               const std::vector<double>& values_mm, double smoothing_mm) {
  Box3 bounds;
  for (const Vec3& p : points_mm) bounds.extend(p);
  RbfModel model;
  model.kernel = kernel;
  model.origin_mm = bounds.center();
  model.centres_mm = points_mm;
  const double scale_mm = 0.5 * bounds.sizes().maxCoeff();
  const auto count = static_cast<Eigen::Index>(points_mm.size());
  const auto terms = static_cast<Eigen::Index>(polynomial_terms(kernel));
  Eigen::VectorXd right = Eigen::VectorXd::Zero(count + terms);
  for (Eigen::Index i = 0; i < count; ++i) right[i] = values_mm[static_cast<std::size_t>(i)];
  const Eigen::VectorXd solved =
      dense_matrix(kernel, points_mm, smoothing_mm, model.origin_mm, scale_mm).partialPivLu().solve(right);
  model.weights.assign(solved.begin(), solved.begin() + count);
  model.polynomial.assign(solved.begin() + count, solved.end());
  for (std::size_t k = 1; k < model.polynomial.size(); ++k) {
    model.polynomial[k] /= k < 4 ? scale_mm : scale_mm * scale_mm;
  }
  return model;
}

}  // namespace spinaltap::test
