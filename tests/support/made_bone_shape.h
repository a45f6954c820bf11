#pragma once

#include <algorithm>
#include <functional>
#include <memory>
#include <vector>

#include "core/anatomy/bone_shape.h"
#include "core/phantom/detail/texture.h"
#include "tests/support/gridded_field.h"

namespace spinaltap::test {

/// What a plane leaves of a field: the side that its normal points away from.
class CutField : public ScalarField {
 public:
  CutField(std::shared_ptr<const ScalarField> whole, const Vec3& point_mm, const Vec3& normal)
      : whole_(std::move(whole)), point_mm_(point_mm), normal_(normal.normalized()) {}

  void evaluate(std::span<const Vec3> points_mm, std::span<double> values_mm,
                std::span<Vec3> gradients) const override {
    whole_->evaluate(points_mm, values_mm, gradients);
    for (std::size_t n = 0; n < points_mm.size(); ++n) {
      const double beyond_mm = normal_.dot(points_mm[n] - point_mm_);
      if (!(beyond_mm > values_mm[n])) continue;
      values_mm[n] = beyond_mm;
      if (!gradients.empty()) gradients[n] = normal_;
    }
  }

 private:
  std::shared_ptr<const ScalarField> whole_;
  Vec3 point_mm_, normal_;
};

/// A solid whose surface seeded noise has moved: of this standard deviation, in grains of 1.5 mm. For gridding only.
class RoughSolid : public Solid {
 public:
  RoughSolid(const Solid& smooth, double deviation_mm, std::uint64_t seed)
      : smooth_(smooth), deviation_mm_(deviation_mm), noise_(Vec3::Constant(1.5), seed) {}

  void evaluate(std::span<const Vec3> points_mm, std::span<double> values_mm, std::span<Vec3>) const override {
    smooth_.evaluate(points_mm, values_mm, {});
    for (std::size_t n = 0; n < points_mm.size(); ++n) values_mm[n] += deviation_mm_ * noise_.at(points_mm[n]);
  }
  Box3 bounds_mm() const override {
    const Box3 box = smooth_.bounds_mm();
    return {box.min() - Vec3::Ones(), box.max() + Vec3::Ones()};
  }
  double hu(const Vec3& p_mm, double distance_mm, double aperture_mm) const override {
    return smooth_.hu(p_mm, distance_mm, aperture_mm);
  }

 private:
  const Solid& smooth_;
  double deviation_mm_;
  Texture noise_;
};

/// A solid's shape as planning sees it.
inline BoneShape shape_of(const Solid& solid) {
  constexpr double kSureMm = 0.3;
  return BoneShape(std::make_shared<GriddedField>(solid), solid.bounds_mm(), kSureMm);
}

}  // namespace spinaltap::test
