#pragma once

#include <memory>

#include "core/base/scalar_field.h"
#include "core/rbf/rbf_model.h"

namespace spinaltap {

namespace detail {
class FastSum;
}

/// A radial basis function that can be evaluated anywhere: term by term below a few thousand centres, by fast multipole
/// sums above. A point's result does not depend on what else is asked for in the same call, nor on the number of
/// threads. Copies share what was prepared.
class RbfField final : public ScalarField {
 public:
  static constexpr double kDefaultAccuracy = 1e-3;

  /// Prepares the sums so that values are within `accuracy_mm`, and gradients within the same number, of the sums term
  /// by term, as measured at some hundreds of places near the centres; an accuracy beyond fast sums is met term by
  /// term. Throws Error when check_model() does, and when the accuracy is not above 0.
  explicit RbfField(RbfModel model, double accuracy_mm = kDefaultAccuracy);

  /// The same where only values are wanted: gradients may be further off.
  static RbfField for_values(RbfModel model, double accuracy_mm) { return {std::move(model), accuracy_mm, false}; }

  void evaluate(std::span<const Vec3> points_mm, std::span<double> values_mm, std::span<Vec3> gradients) const override;

  const RbfModel& model() const { return *model_; }
  std::size_t centre_count() const { return model_->weights.size(); }

  /// Largest differences met when the sums were checked; 0 where they go term by term.
  double value_error_mm() const { return value_error_mm_; }
  double gradient_error() const { return gradient_error_; }

 private:
  RbfField(RbfModel model, double accuracy_mm, bool with_gradients);

  std::shared_ptr<const RbfModel> model_;
  std::shared_ptr<const detail::FastSum> fast_;  ///< null: term by term
  double value_error_mm_ = 0.0;
  double gradient_error_ = 0.0;
};

}  // namespace spinaltap
