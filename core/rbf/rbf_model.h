#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "core/base/geometry.h"

namespace spinaltap {

/// Basic functions of distance r (mm) in space. Each is the Green's function of a power of the Laplacian, so that the
/// interpolant is the smoothest one in that sense (Carr et al. 2001, section 3).
enum class RadialKernel {
  biharmonic,   ///< phi(r) = r, with a linear polynomial: least bending, the default
  triharmonic,  ///< phi(r) = r^3, with a quadratic polynomial: smoother, and further off where there is no data
};

/// Terms of the polynomial that goes with a kernel: 4 (linear) or 10 (quadratic).
constexpr std::size_t polynomial_terms(RadialKernel kernel) { return kernel == RadialKernel::biharmonic ? 4 : 10; }

/// The power of r.
constexpr int power_of(RadialKernel kernel) { return kernel == RadialKernel::biharmonic ? 1 : 3; }

/// 1 where the matrix of phi is positive on weights that the side conditions allow, -1 where it is negative.
constexpr double definite_sign(RadialKernel kernel) { return kernel == RadialKernel::biharmonic ? -1.0 : 1.0; }

/// phi at squared distance `r2` (mm^2) + `c2`: with c2 = width^2 the basic function is its own low-pass filtered self,
/// (r^2 + c^2)^(m/2) (Carr et al. 2003, section 4).
inline double phi(RadialKernel kernel, double r2, double c2 = 0.0) {
  const double s = std::sqrt(r2 + c2);
  return kernel == RadialKernel::biharmonic ? s : s * s * s;
}

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
