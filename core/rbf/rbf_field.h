#pragma once

#include <vector>

#include "core/base/scalar_field.h"

namespace spinaltap {

/// A biharmonic radial basis function with a linear polynomial,
///   s(x) = sum_i w_i |x - c_i| + a0 + a . (x - o)
/// (Carr et al. 2001, equation 6 with phi(r) = r), evaluated by direct summation.
class RbfField final : public ScalarField {
 public:
  /// `weights` has one entry a centre, then the constant and the three linear coefficients. `origin_mm` is the point
  /// from which the polynomial measures. Throws Error when sizes do not fit or a number is not finite.
  RbfField(std::vector<Vec3> centres_mm, const Eigen::VectorXd& weights, const Vec3& origin_mm);

  void evaluate(std::span<const Vec3> points_mm, std::span<double> values_mm, std::span<Vec3> gradients) const override;

  std::size_t centre_count() const { return static_cast<std::size_t>(weight_.size()); }

 private:
  void evaluate_one(const Vec3& p_mm, double& value_mm, Vec3* gradient) const;

  Eigen::ArrayXd x_mm_;  ///< centres relative to origin_mm_, one array a coordinate, so that loops over them vectorise
  Eigen::ArrayXd y_mm_;
  Eigen::ArrayXd z_mm_;
  Eigen::ArrayXd weight_;
  double constant_ = 0.0;
  Vec3 linear_ = Vec3::Zero();
  Vec3 origin_mm_ = Vec3::Zero();
};

}  // namespace spinaltap
