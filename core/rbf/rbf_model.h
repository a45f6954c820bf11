#pragma once

#include <vector>

#include "core/base/geometry.h"
#include "core/rbf/radial_kernel.h"

namespace spinaltap {

/// A radial basis function as numbers, what a file holds:
///   s(x) = sum_i weights[i] phi(|x - centres_mm[i]|) + sum_k polynomial[k] q_k(x - origin_mm),
/// q = 1, x, y, z and, for the triharmonic kernel, xx, xy, xz, yy, yz, zz.
struct RbfModel {
  RadialKernel kernel = RadialKernel::biharmonic;
  double low_pass_mm = 0.0;        ///< width c of the low-pass filter: phi(sqrt(r^2 + c^2)); 0 filters nothing
  Vec3 origin_mm = Vec3::Zero();   ///< from which the polynomial measures
  std::vector<Vec3> centres_mm;    ///< patient LPS
  std::vector<double> weights;     ///< one a centre; mm per phi(mm)
  std::vector<double> polynomial;  ///< 4 or 10 coefficients, mm per power of mm
};

/// Throws Error, with what was expected, when sizes do not fit or a number is not finite.
void check_model(const RbfModel& model);

}  // namespace spinaltap
