#include "core/rbf/rbf_field.h"

#include <tbb/parallel_for.h>

#include <cmath>

#include "core/base/error.h"

namespace spinaltap {

RbfField::RbfField(std::vector<Vec3> centres_mm, const Eigen::VectorXd& weights, const Vec3& origin_mm)
    : origin_mm_(origin_mm) {
  const auto count = static_cast<Eigen::Index>(centres_mm.size());
  if (weights.size() != count + 4) fail("RBF: expected ", count + 4, " weights, found ", weights.size());
  if (!weights.allFinite() || !origin_mm.allFinite()) fail("RBF: a weight is not a number");
  x_mm_.resize(count);
  y_mm_.resize(count);
  z_mm_.resize(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Vec3 c = centres_mm[static_cast<std::size_t>(i)] - origin_mm;
    if (!c.allFinite()) fail("RBF: a centre is not a number");
    x_mm_[i] = c.x();
    y_mm_[i] = c.y();
    z_mm_[i] = c.z();
  }
  weight_ = weights.head(count).array();
  constant_ = weights[count];
  linear_ = weights.tail(3);
}

void RbfField::evaluate_one(const Vec3& p_mm, double& value_mm, Vec3* gradient) const {
  constexpr Eigen::Index kBlock = 256;  // a block's differences stay in the first-level cache
  using Block = Eigen::Array<double, Eigen::Dynamic, 1, 0, kBlock, 1>;
  const Vec3 p = p_mm - origin_mm_;
  double sum = constant_ + linear_.dot(p);
  Vec3 slope = linear_;
  for (Eigen::Index begin = 0; begin < weight_.size(); begin += kBlock) {
    const Eigen::Index size = std::min(kBlock, weight_.size() - begin);
    const Block dx = p.x() - x_mm_.segment(begin, size);
    const Block dy = p.y() - y_mm_.segment(begin, size);
    const Block dz = p.z() - z_mm_.segment(begin, size);
    const Block distance = (dx.square() + dy.square() + dz.square()).sqrt();
    const auto weight = weight_.segment(begin, size);
    sum += (weight * distance).sum();
    if (gradient == nullptr) continue;
    // |x - c| has no gradient at its centre; the sum's other terms are what is left there.
    const Block share = weight / distance.max(1e-300);
    slope += Vec3((share * dx).sum(), (share * dy).sum(), (share * dz).sum());
  }
  value_mm = sum;
  if (gradient != nullptr) *gradient = slope;
}

void RbfField::evaluate(std::span<const Vec3> points_mm, std::span<double> values_mm, std::span<Vec3> gradients) const {
  constexpr std::size_t kGrain = 64;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points_mm.size(), kGrain), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      evaluate_one(points_mm[i], values_mm[i], gradients.empty() ? nullptr : &gradients[i]);
    }
  });
}

}  // namespace spinaltap
