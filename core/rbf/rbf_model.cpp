#include "core/rbf/rbf_model.h"

#include <algorithm>

#include "core/base/error.h"

namespace spinaltap {

void check_model(const RbfModel& model) {
  const auto finite = [](double value) { return std::isfinite(value); };
  if (model.weights.size() != model.centres_mm.size()) {
    fail("RBF: expected a weight for each of ", model.centres_mm.size(), " centres, found ", model.weights.size());
  }
  if (model.polynomial.size() != polynomial_terms(model.kernel)) {
    fail("RBF: expected ", polynomial_terms(model.kernel), " polynomial coefficients, found ", model.polynomial.size());
  }
  if (!(model.low_pass_mm >= 0.0) || !finite(model.low_pass_mm)) {
    fail("RBF: expected a low-pass width of 0 mm or more, found ", model.low_pass_mm);
  }
  if (!std::all_of(model.centres_mm.begin(), model.centres_mm.end(), [](const Vec3& c) { return c.allFinite(); })) {
    fail("RBF: a centre is not a number");
  }
  if (!std::all_of(model.weights.begin(), model.weights.end(), finite) ||
      !std::all_of(model.polynomial.begin(), model.polynomial.end(), finite) || !model.origin_mm.allFinite()) {
    fail("RBF: a weight is not a number");
  }
}

}  // namespace spinaltap
