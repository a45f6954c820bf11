#pragma once

#include <cmath>
#include <span>

#include "core/rbf/rbf_model.h"

namespace spinaltap::test {

/// A sum of basic functions, written as the formula says, and how large its terms are: what rounding is measured by.
struct PlainSum {
  double value = 0.0;
  Vec3 gradient = Vec3::Zero();
  double size = 0.0;           ///< sum of the terms' magnitudes
  double gradient_size = 0.0;  ///< the same of their gradients
};

/// sum_j w_j (|p - c_j|^2 + width^2)^(power/2); power 1 for the biharmonic kernel, 3 for the triharmonic one.
inline PlainSum plain_sum(RadialKernel kernel, double width_mm, std::span<const Vec3> centres_mm,
                          std::span<const double> weights, const Vec3& p_mm) {
  PlainSum sum;
  for (std::size_t j = 0; j < centres_mm.size(); ++j) {
    const Vec3 d = p_mm - centres_mm[j];
    const double r = std::sqrt(d.squaredNorm() + width_mm * width_mm);
    const bool is_biharmonic = kernel == RadialKernel::biharmonic;
    const double term = weights[j] * (is_biharmonic ? r : r * r * r);
    sum.value += term;
    sum.size += std::abs(term);
    if (r == 0.0) continue;
    const Vec3 slope = weights[j] * (is_biharmonic ? 1.0 / r : 3.0 * r) * d;
    sum.gradient += slope;
    sum.gradient_size += slope.norm();
  }
  return sum;
}

/// The polynomial as its doc says.
inline double plain_polynomial(const RbfModel& model, const Vec3& p_mm) {
  const Vec3 d = p_mm - model.origin_mm;
  const auto& c = model.polynomial;
  double value = c[0] + c[1] * d.x() + c[2] * d.y() + c[3] * d.z();
  if (model.kernel == RadialKernel::triharmonic) {
    value += c[4] * d.x() * d.x() + c[5] * d.x() * d.y() + c[6] * d.x() * d.z() + c[7] * d.y() * d.y() +
             c[8] * d.y() * d.z() + c[9] * d.z() * d.z();
  }
  return value;
}

inline double plain_value(const RbfModel& model, const Vec3& p_mm) {
  return plain_sum(model.kernel, model.low_pass_mm, model.centres_mm, model.weights, p_mm).value +
         plain_polynomial(model, p_mm);
}

}  // namespace spinaltap::test
