#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/geometry.h"
#include "core/rbf/rbf_model.h"

namespace spinaltap {

inline constexpr std::size_t kMaxPolynomialTerms = 10;

/// The monomials q_k(d) of a kernel's polynomial: 1, x, y, z, and xx, xy, xz, yy, yz, zz for the triharmonic one.
inline std::array<double, kMaxPolynomialTerms> polynomial_row(RadialKernel kernel, const Vec3& d) {
  std::array<double, kMaxPolynomialTerms> row{1.0, d.x(), d.y(), d.z()};
  if (kernel == RadialKernel::triharmonic) {
    row = {1.0,           d.x(),         d.y(),         d.z(),         d.x() * d.x(),
           d.x() * d.y(), d.x() * d.z(), d.y() * d.y(), d.y() * d.z(), d.z() * d.z()};
  }
  return row;
}

/// sum_k coefficients[k] q_k(d).
double polynomial_value(RadialKernel kernel, std::span<const double> coefficients, const Vec3& d);
Vec3 polynomial_gradient(RadialKernel kernel, std::span<const double> coefficients, const Vec3& d);

namespace detail {

/// As many points as the polynomial has terms, on which it is determined: the pivots of an elimination, widest first.
/// Throws Error when the points lie in a plane (on a quadric).
std::vector<std::uint32_t> determining_points(RadialKernel kernel, std::span<const Vec3> points_mm);

}  // namespace detail
}  // namespace spinaltap
