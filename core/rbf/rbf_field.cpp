#include "core/rbf/rbf_field.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/base/random.h"
#include "core/rbf/detail/fast_sum.h"
#include "core/rbf/detail/polynomial.h"

namespace spinaltap {
namespace {

constexpr std::size_t kMaxDirect = 2000;  // centres: with more of them, fast sums pay from 20,000 places on
constexpr std::size_t kFieldLeafSize = 64;
constexpr std::size_t kFieldBesideSize = 512;  // anywhere costs no more than near, and preparing hardly more
constexpr int kFirstOrder = 5;

/// Places to check the sums at: beside centres, up to a hundredth of the whole away, and all over their box.
std::vector<Vec3> sample_places(const std::vector<Vec3>& centres_mm) {
  constexpr std::size_t kSamples = 512;
  constexpr std::size_t kAnywhere = 256;
  constexpr std::uint64_t kSeed = 0x5bf0;
  constexpr double kReach = 0.01;
  const Box3 bounds = bounds_of(centres_mm);
  const double reach_mm = kReach * bounds.sizes().maxCoeff();
  std::vector<Vec3> places_mm;
  for (std::uint64_t i = 0; i < kSamples; ++i) {
    const auto part = static_cast<double>(i) / static_cast<double>(kSamples);
    const Vec3& centre = centres_mm[static_cast<std::size_t>(part * static_cast<double>(centres_mm.size()))];
    const auto shift = [&](std::uint64_t axis) { return 2.0 * random_uniform(kSeed + axis, i) - 1.0; };
    places_mm.emplace_back(centre + reach_mm * Vec3(shift(0), shift(1), shift(2)));
  }
  for (std::uint64_t i = kSamples; i < kSamples + kAnywhere; ++i) {
    const auto part = [&](std::uint64_t axis) { return random_uniform(kSeed + axis, i); };
    places_mm.emplace_back(bounds.min() + bounds.sizes().cwiseProduct(Vec3(part(0), part(1), part(2))));
  }
  return places_mm;
}

}  // namespace

RbfField::RbfField(RbfModel model, double accuracy_mm) : RbfField(std::move(model), accuracy_mm, true) {}

RbfField::RbfField(RbfModel model, double accuracy_mm, bool with_gradients) {
  check_model(model);
  if (!(accuracy_mm > 0.0)) fail("RBF: expected an accuracy above 0 mm, found ", accuracy_mm);
  model_ = std::make_shared<const RbfModel>(std::move(model));
  if (model_->weights.size() <= kMaxDirect) return;

  constexpr double kShare = 0.4;  // of the accuracy, for what the places looked at show
  const std::vector<Vec3> places_mm = sample_places(model_->centres_mm);
  std::vector<double> direct(places_mm.size());
  std::vector<Vec3> direct_gradient(places_mm.size());
  detail::direct_sums(model_->kernel, model_->low_pass_mm, model_->centres_mm, model_->weights, places_mm, direct,
                      direct_gradient);
  std::vector<double> values(places_mm.size());
  std::vector<Vec3> gradients(places_mm.size());
  for (int order = kFirstOrder; order <= detail::kMaxOrder;) {
    const auto fast = std::make_shared<detail::FastSum>(
        model_->kernel, model_->low_pass_mm, model_->centres_mm,
        detail::FastSumOptions{.order = order, .leaf_size = kFieldLeafSize, .beside_size = kFieldBesideSize});
    fast->set_weights(model_->weights);
    fast->evaluate(places_mm, values, gradients);
    value_error_mm_ = 0.0;
    gradient_error_ = 0.0;
    for (std::size_t i = 0; i < places_mm.size(); ++i) {
      value_error_mm_ = std::max(value_error_mm_, std::abs(values[i] - direct[i]));
      gradient_error_ = std::max(gradient_error_, (gradients[i] - direct_gradient[i]).norm());
    }
    const double error = with_gradients ? std::max(value_error_mm_, gradient_error_) : value_error_mm_;
    if (error <= kShare * accuracy_mm) {
      fast_ = fast;
      return;
    }
    // Each order gives most of a digit.
    constexpr double kDigitsAnOrder = 0.8;
    const double missing = std::min(100.0, std::log10(error / (kShare * accuracy_mm)));
    const int next = order + std::max(1, static_cast<int>(missing / kDigitsAnOrder));
    order = order < detail::kMaxOrder ? std::min(detail::kMaxOrder, next) : next;
  }
  // No fast sum is that accurate: term by term then.
  value_error_mm_ = 0.0;
  gradient_error_ = 0.0;
}

void RbfField::evaluate(std::span<const Vec3> points_mm, std::span<double> values_mm, std::span<Vec3> gradients) const {
  if (fast_) {
    fast_->evaluate(points_mm, values_mm, gradients);
  } else {
    detail::direct_sums(model_->kernel, model_->low_pass_mm, model_->centres_mm, model_->weights, points_mm, values_mm,
                        gradients);
  }
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points_mm.size(), 4096), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      const Vec3 d = points_mm[i] - model_->origin_mm;
      values_mm[i] += polynomial_value(model_->kernel, model_->polynomial, d);
      if (!gradients.empty()) gradients[i] += polynomial_gradient(model_->kernel, model_->polynomial, d);
    }
  });
}

}  // namespace spinaltap
