#include "core/rbf/detail/polynomial.h"

#include <algorithm>

#include "core/base/error.h"

namespace spinaltap {

double polynomial_value(RadialKernel kernel, std::span<const double> coefficients, const Vec3& d) {
  const auto row = polynomial_row(kernel, d);
  double sum = 0.0;
  for (std::size_t k = 0; k < coefficients.size(); ++k) sum += coefficients[k] * row[k];
  return sum;
}

Vec3 polynomial_gradient(RadialKernel kernel, std::span<const double> coefficients, const Vec3& d) {
  const auto& c = coefficients;
  Vec3 gradient(c[1], c[2], c[3]);
  if (kernel == RadialKernel::triharmonic) {
    gradient += Vec3(2.0 * c[4] * d.x() + c[5] * d.y() + c[6] * d.z(), c[5] * d.x() + 2.0 * c[7] * d.y() + c[8] * d.z(),
                     c[6] * d.x() + c[8] * d.y() + 2.0 * c[9] * d.z());
  }
  return gradient;
}

namespace detail {

std::vector<std::uint32_t> determining_points(RadialKernel kernel, std::span<const Vec3> points_mm) {
  constexpr double kFlat = 1e-7;  // of the points' extent
  const std::size_t terms = polynomial_terms(kernel);
  if (points_mm.size() < terms) {
    fail("RBF: expected ", terms, " points or more that differ, found ", points_mm.size());
  }
  const Box3 bounds = bounds_of(points_mm);
  const double per_mm = 1.0 / std::max(0.5 * bounds.sizes().maxCoeff(), 1e-300);
  std::vector<std::array<double, kMaxPolynomialTerms>> rows;
  rows.reserve(points_mm.size());
  for (const Vec3& p : points_mm) rows.push_back(polynomial_row(kernel, (p - bounds.center()) * per_mm));

  std::vector<std::uint32_t> pivots;
  std::array<bool, kMaxPolynomialTerms> used{};
  for (std::size_t step = 0; step < terms; ++step) {
    double largest = 0.0;
    std::size_t pivot = 0;
    std::size_t column = 0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      for (std::size_t k = 0; k < terms; ++k) {
        if (used[k] || !(std::abs(rows[i][k]) > largest)) continue;
        largest = std::abs(rows[i][k]);
        pivot = i;
        column = k;
      }
    }
    if (!(largest > kFlat)) {
      fail("RBF: the points lie ", kernel == RadialKernel::biharmonic ? "in a plane" : "on a quadric",
           "; a surface needs points that do not");
    }
    pivots.push_back(static_cast<std::uint32_t>(pivot));
    used[column] = true;
    const auto pivot_row = rows[pivot];
    for (auto& row : rows) {
      const double factor = row[column] / pivot_row[column];
      for (std::size_t k = 0; k < terms; ++k) row[k] -= factor * pivot_row[k];
    }
  }
  return pivots;
}

}  // namespace detail
}  // namespace spinaltap
