#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "core/base/geometry.h"

namespace spinaltap {

/// A polynomial of degree 3 of three variables, by least squares through values at places of the cube [-1, 1]^3.
class CubicPolynomial {
 public:
  static constexpr int kTerms = 20;

  void add(const Vec3& place, double value, double weight);
  /// Where it has its minimum in the cube; nothing where Newton's method, from 0, finds none.
  std::optional<Vec3> minimum() const;

 private:
  using Row = Eigen::Matrix<double, kTerms, 1>;

  Eigen::Matrix<double, kTerms, kTerms> matrix_ = Eigen::Matrix<double, kTerms, kTerms>::Zero();
  Row right_ = Row::Zero();
};

}  // namespace spinaltap
