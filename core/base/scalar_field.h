#pragma once

#include <span>

#include "core/base/geometry.h"

namespace spinaltap {

/// A smooth function of space whose zero set is a surface: negative inside, positive outside.
class ScalarField {
 public:
  ScalarField() = default;
  ScalarField(const ScalarField&) = default;
  ScalarField& operator=(const ScalarField&) = default;
  virtual ~ScalarField() = default;

  /// Values (mm) and gradients at points (patient LPS, mm). `gradients` is empty when they are not wanted; otherwise
  /// all spans have one length. Safe to call from many threads at once.
  virtual void evaluate(std::span<const Vec3> points_mm, std::span<double> values_mm,
                        std::span<Vec3> gradients) const = 0;
};

}  // namespace spinaltap
